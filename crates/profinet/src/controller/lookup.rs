//! The way to a connection: the name is looked up, the address set, the connect sent, its answer taken.

use alloc::vec::Vec;

use super::ar::{Ar, Purpose, Shared};
use super::calls::Op;
use super::config::{Resolve, RtClass};
use super::connect::{self, Agreement};
use super::dcp::{DcpEvent, Filter, IdentifyOptions, Setting};
use super::error::{DcpError, LostCause, ServiceError};
use super::event::{DcpId, DcpReply, Event, Station};
use super::phase::{Phase, Trigger};
use crate::alarm::{AlarmConfig, Alarms};
use crate::cyclic::{Consumer, Provider, ProviderConfig};
use crate::rpc::{CallError, Reply};
use crate::wire::dcp::Qualifier;
use crate::wire::ethernet::{FrameId, Tag};
use crate::wire::rt::Iops;
use crate::{Instant, IpSuite};

/// State of looking a name up.
#[derive(Debug, Default)]
pub(super) struct Lookup {
    /// How.
    pub resolve: Resolve,
    /// The open DCP request.
    pub dcp: Option<DcpId>,
    /// Who answered.
    pub answers: Vec<Station>,
    /// Until when others may answer.
    pub settle: Option<Instant>,
}

/// Maximum number of stored answers of one name: enough for the error message.
const MAX_ANSWERS: usize = 16;

impl Ar {
    /// First step: look the name up, or connect at once.
    pub(super) fn start(&mut self, shared: &mut Shared<'_>) {
        if self.lookup.resolve == Resolve::Trust {
            self.advance(Trigger::Found);
            self.push(shared, Op::Connect);
            return;
        }
        let filter = Filter::name(&self.target.name);
        // three requests within 1.2 s; a device that was busy with another request receives one of them
        let options = IdentifyOptions {
            delay_factor: 1,
            margin: core::time::Duration::from_millis(1190),
            sends: 3,
        };
        self.lookup.dcp = shared.dcp.identify(shared.now, filter, options);
        if self.lookup.dcp.is_none() {
            let name = self.target.name.clone();
            self.lose(shared, LostCause::NoStation { name });
        }
    }

    /// Takes an event of the open DCP request.
    pub(super) fn handle_dcp(&mut self, shared: &mut Shared<'_>, event: DcpEvent) {
        match event {
            DcpEvent::Identified(_, station, _) => self.answered(shared, station),
            DcpEvent::IdentifyDone(..) => {
                self.lookup.dcp = None;
                if self.phase == Phase::Resolve {
                    self.resolved(shared);
                }
            }
            DcpEvent::Done(_, result) => {
                self.lookup.dcp = None;
                self.ip_set(shared, result);
            }
            DcpEvent::Hello(_) => {}
        }
    }

    fn answered(&mut self, shared: &mut Shared<'_>, station: Station) {
        // filtering is the device's duty; one that ignores the filter is not the target
        if station.name != self.target.name || self.lookup.answers.len() >= MAX_ANSWERS {
            return;
        }
        self.lookup.answers.push(station);
        let starting = !matches!(self.phase, Phase::Resolve | Phase::Data | Phase::Access);
        if self.lookup.answers.len() > 1 && starting {
            self.several(shared);
        } else if self.phase == Phase::Resolve && self.lookup.settle.is_none() {
            self.lookup.settle = Some(shared.now + shared.timeouts.name_check);
        }
    }

    fn several(&mut self, shared: &mut Shared<'_>) {
        let name = self.target.name.clone();
        let macs = self.lookup.answers.iter().map(|s| s.mac).collect();
        self.lose(shared, LostCause::SeveralStations { name, macs });
    }

    /// Continues when no other station answered in time.
    pub(super) fn lookup_due(&mut self, shared: &mut Shared<'_>) {
        if self.lookup.settle.is_some_and(|settle| shared.now >= settle) {
            self.lookup.settle = None;
            if self.phase == Phase::Resolve {
                self.resolved(shared);
            }
        }
    }

    fn resolved(&mut self, shared: &mut Shared<'_>) {
        let name = self.target.name.clone();
        let station = match &self.lookup.answers[..] {
            [] => return self.lose(shared, LostCause::NoStation { name }),
            [station] => station.clone(),
            _ => return self.several(shared),
        };
        let expected = (self.target.vendor_id, self.target.device_id);
        let found = (station.vendor_id, station.device_id);
        if expected != found {
            return self.lose(
                shared,
                LostCause::WrongDevice {
                    name,
                    expected,
                    found,
                },
            );
        }
        if let Some(expected) = self.target.mac.filter(|mac| *mac != station.mac) {
            return self.lose(
                shared,
                LostCause::OtherMac {
                    name,
                    expected,
                    found: station.mac,
                },
            );
        }
        self.target.mac = Some(station.mac);
        let wanted = self.target.ip;
        if !wanted.is_set() || wanted.address == station.ip.address {
            if !station.ip.is_set() {
                return self.lose(shared, LostCause::NoIp { name });
            }
            self.target.ip = station.ip;
            if self.advance(Trigger::Found) {
                self.push(shared, Op::Connect);
            }
        } else if self.lookup.resolve == Resolve::SetIp {
            self.set_ip(shared, &station, wanted);
        } else if !station.ip.is_set() {
            self.lose(shared, LostCause::NoIp { name });
        } else {
            let (expected, found) = (wanted.address, station.ip.address);
            self.lose(
                shared,
                LostCause::OtherIp {
                    name,
                    expected,
                    found,
                },
            );
        }
    }

    fn set_ip(&mut self, shared: &mut Shared<'_>, station: &Station, wanted: IpSuite) {
        if let Some(id) = self.lookup.dcp.take() {
            shared.dcp.cancel(id);
        }
        let setting = Setting::Ip(Qualifier::TEMPORARY, wanted);
        self.advance(Trigger::OtherIp);
        self.lookup.dcp = shared.dcp.set(shared.now, station.mac, setting, None);
        if self.lookup.dcp.is_none() {
            let error = DcpError::Timeout {
                mac: station.mac,
                sends: 0,
            };
            self.lose(shared, LostCause::SetIp(error));
        }
    }

    fn ip_set(&mut self, shared: &mut Shared<'_>, result: Result<DcpReply, DcpError>) {
        match result {
            Ok(_) => {
                if self.advance(Trigger::IpSet) {
                    self.push(shared, Op::Connect);
                }
            }
            Err(error) => self.lose(shared, LostCause::SetIp(error)),
        }
    }

    fn input_id(&self) -> FrameId {
        let class = match &self.purpose {
            Purpose::Cyclic { config, .. } => config.rt_class,
            Purpose::Access { .. } => RtClass::Class2,
        };
        connect::input_frame_id(class, self.id.slot)
    }

    /// LocalAlarmReference of this connection: names its place.
    const fn alarm_reference(&self) -> u16 {
        self.id.slot + 1
    }

    pub(super) fn connect_stub(&self) -> Vec<u8> {
        let blocks = match &self.purpose {
            Purpose::Access {
                activity_timeout_factor,
            } => connect::access_request(&self.identity, *activity_timeout_factor),
            Purpose::Cyclic {
                config,
                input,
                output,
            } => {
                let layouts = (input, output);
                connect::request(
                    &self.identity,
                    config,
                    layouts,
                    self.input_id(),
                    self.alarm_reference(),
                )
            }
        };
        connect::stub(&blocks)
    }

    /// Takes the answer to the connect request.
    pub(super) fn connected(&mut self, shared: &mut Shared<'_>, reply: &Result<Reply, CallError>) {
        let (mac, input_id) = (self.target.mac, self.input_id());
        let result: Result<Option<Agreement>, ServiceError> = match &self.purpose {
            Purpose::Access { .. } => connect::check_access(reply, &self.identity, mac).map(|mac| {
                self.target.mac = Some(mac);
                None
            }),
            Purpose::Cyclic { config, .. } => {
                connect::check_response(reply, &self.identity, config, mac, input_id).map(Some)
            }
        };
        match result {
            Err(error) => self.lose(shared, LostCause::Service(error)),
            Ok(None) => {
                self.advance(Trigger::AccessGranted);
                shared.events.push_back(Event::Connected {
                    ar: self.id,
                    diff: None,
                });
            }
            Ok(Some(agreement)) => {
                self.open_cyclic(shared, &agreement, input_id);
                self.advance(Trigger::Accepted);
                shared.events.push_back(Event::Connected {
                    ar: self.id,
                    diff: agreement.diff,
                });
                self.parameterize();
            }
        }
    }

    /// Frames go out and are taken from here on.
    fn open_cyclic(&mut self, shared: &mut Shared<'_>, agreement: &Agreement, input_id: FrameId) {
        let Purpose::Cyclic {
            config,
            input,
            output,
        } = &self.purpose
        else {
            return;
        };
        self.target.mac = Some(agreement.mac);
        let send = ProviderConfig {
            destination: agreement.mac,
            source: self.identity.mac,
            tag: Some(Tag::PRIORITY_6),
            frame_id: agreement.output_id,
            timing: config.timing,
            // the first frame leaves at once
            origin: shared.now,
        };
        let mut provider = Provider::new(send, output.clone(), shared.now);
        provider.set_all_iocs(Iops::GOOD);
        self.provider = Some(provider);
        self.consumer = Some(Consumer::new(
            agreement.mac,
            input_id,
            config.timing,
            config.data_hold_factor,
            input.clone(),
        ));
        self.alarms = Some(Alarms::new(AlarmConfig {
            local: self.identity.mac,
            peer: agreement.mac,
            local_reference: self.alarm_reference(),
            peer_reference: agreement.alarm_reference,
            timeout: core::time::Duration::from_millis(100) * u32::from(config.rta_timeout_factor),
            retries: config.rta_retries,
            tag_high: Tag::PRIORITY_6,
            tag_low: Tag::PRIORITY_5,
            max_length: agreement.max_alarm_length,
            low_only: false,
        }));
        self.apply_run();
    }
}
