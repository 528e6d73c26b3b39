//! Finding stations, and giving them names and addresses.

use std::time::Duration;

use profinet::controller::{DcpId, DcpReply, Filter, IdentifyOptions, Misuse, Station};
use profinet::wire::dcp::DcpOption;
use profinet::{Instant, IpSuite, MacAddress};

use super::Session;
use crate::{Client, Discovered, Drive, DriveAddress, Error};

/// Longer than any DCP request may take with its repetitions.
const DCP_LIMIT: Duration = Duration::from_secs(30);
/// Longer than the endpoint mapper may take with all repetitions.
const MAPPER_LIMIT: Duration = Duration::from_secs(10);
/// How long a second station of the same name may take to answer: ten times the response delay requested.
const SECOND_ANSWER: Duration = Duration::from_millis(100);
/// How long one station may take to answer who it is.
const DIRECT_ANSWER: Duration = Duration::from_millis(500);
/// What a station says of itself when it answers an Identify request.
const IDENTITY: [DcpOption; 9] = [
    DcpOption::IP,
    DcpOption::NAME,
    DcpOption::DEVICE_ID,
    DcpOption::STATION_TYPE,
    DcpOption::ROLE,
    DcpOption::OPTIONS,
    DcpOption::ALIAS,
    DcpOption::INSTANCE,
    DcpOption::OEM_DEVICE_ID,
];

impl Session {
    /// Returns all stations that answer within `time`, by name and address.
    ///
    /// # Errors
    /// When the medium fails or the caller requests a stop.
    pub async fn scan(&mut self, time: Duration) -> Result<Discovered, Error> {
        let factor = u16::try_from(time.as_millis() / 20)
            .unwrap_or(u16::MAX)
            .clamp(1, 6400);
        let margin = time.saturating_sub(Duration::from_millis(10) * u32::from(factor));
        self.identify(
            Filter::all(),
            IdentifyOptions {
                delay_factor: factor,
                margin,
                sends: 2,
            },
        )
        .await
    }

    /// Reports each station to `report` as soon as it answers, most of them within 100 ms: for what cannot wait until all have
    /// answered. Returns true where more stations answered than one search takes: those are not reported.
    ///
    /// # Errors
    /// When the medium fails or the caller requests a stop.
    pub async fn scan_quickly(&mut self, report: impl FnMut(&Station)) -> Result<bool, Error> {
        let quick = IdentifyOptions {
            delay_factor: 10,
            ..IdentifyOptions::MANY
        };
        let found = self.identify_each(Filter::all(), quick, report).await?;
        Ok(found.more)
    }

    /// Sends one Identify request, without a repetition, and returns who answered within `time`, each with the time until its
    /// answer was here. Ends early once `expected` stations answered. Who is missing lost the request or the answer.
    ///
    /// # Errors
    /// When the medium fails or the caller requests a stop.
    pub async fn identify_once(
        &mut self,
        expected: usize,
        time: Duration,
    ) -> Result<Vec<(Station, Duration)>, Error> {
        let options = IdentifyOptions {
            delay_factor: 1,
            margin: time.saturating_sub(Duration::from_millis(10)),
            sends: 1,
        };
        let begin = self.now();
        let id = self
            .client()
            .controller()
            .identify_with(begin, Filter::all(), options)?;
        let mut times = Vec::new();
        loop {
            let known = times.len();
            let answered = self
                .wait(time + DCP_LIMIT, |client| {
                    let count = client.stations_so_far(id).len();
                    if count > known {
                        return Some((count, None));
                    }
                    let all = client.take_stations(id)?.stations;
                    Some((all.len(), Some(all)))
                })
                .await?;
            let (count, all) = answered.unwrap_or((known, None));
            times.resize(count, self.now() - begin);
            if let Some(all) = all {
                return Ok(all.into_iter().zip(times).collect());
            }
            if count == known || count >= expected {
                self.client().controller().cancel_dcp(id);
                let all = self.client().take_stations_so_far(id);
                return Ok(all.into_iter().zip(times).collect());
            }
        }
    }

    async fn identify(&mut self, filter: Filter, options: IdentifyOptions) -> Result<Discovered, Error> {
        self.identify_each(filter, options, |_| ()).await
    }

    async fn identify_each(
        &mut self,
        filter: Filter,
        options: IdentifyOptions,
        mut report: impl FnMut(&Station),
    ) -> Result<Discovered, Error> {
        let now = self.now();
        let id = self.client().controller().identify_with(now, filter, options)?;
        let limit = Duration::from_millis(10) * u32::from(options.delay_factor) + options.margin + DCP_LIMIT;
        let mut reported = 0;
        let mut found = self
            .wait(limit, |client| {
                let so_far = client.stations_so_far(id);
                so_far.iter().skip(reported).for_each(&mut report);
                reported = reported.max(so_far.len());
                client.take_stations(id)
            })
            .await?
            .unwrap_or_default();
        found
            .stations
            .sort_by(|a, b| (&a.name, a.ip.address, a.mac).cmp(&(&b.name, b.ip.address, b.mac)));
        Ok(found)
    }

    /// Identifies the station of a filter that fits only one: ends soon after the first answer.
    async fn identify_one(&mut self, filter: Filter) -> Result<Vec<Station>, Error> {
        let now = self.now();
        let id = self
            .client()
            .controller()
            .identify_with(now, filter, IdentifyOptions::ONE)?;
        let mut stations = self
            .wait(DCP_LIMIT, |client| {
                (!client.stations_so_far(id).is_empty())
                    .then(Vec::new)
                    .or_else(|| Some(client.take_stations(id)?.stations))
            })
            .await?;
        if !self.client().stations_so_far(id).is_empty() {
            self.pass(SECOND_ANSWER).await?;
            self.client().controller().cancel_dcp(id);
            stations = Some(self.client().take_stations_so_far(id));
        }
        Ok(stations.unwrap_or_default())
    }

    /// Returns the one station that is meant.
    ///
    /// # Errors
    /// [`Error::NotFound`] with who answered instead, [`Error::Ambiguous`] with all MAC addresses.
    pub async fn find(&mut self, drive: &DriveAddress) -> Result<Drive, Error> {
        match (drive, self.is_on_line()) {
            (DriveAddress::Line(at), true) => return self.find_on_line(at).await,
            (DriveAddress::Line(_), false) | (_, true) => {
                return Err(Error::OtherWire { drive: drive.clone() });
            }
            _ if !self.engine.discovers() => return self.find_by_trust(drive).await,
            _ => {}
        }
        let filter = match drive {
            DriveAddress::Name(name) => Filter::name(name),
            _ => Filter::all(),
        };
        let answers = match drive {
            DriveAddress::Name(_) => self.identify_one(filter).await?,
            DriveAddress::Mac(mac) => self.ask_station(*mac).await?,
            _ => self.identify(filter, IdentifyOptions::MANY).await?.stations,
        };
        let fits = |station: &&Station| match drive {
            DriveAddress::Name(name) => station.name == *name,
            DriveAddress::Ip(ip) => station.ip.address == *ip,
            DriveAddress::Mac(mac) => station.mac == *mac,
            DriveAddress::Line(_) => false,
        };
        let answered = match drive {
            // one that answers too late, or not to what was asked of it alone, may be among all
            DriveAddress::Name(_) | DriveAddress::Mac(_) if !answers.iter().any(|station| fits(&station)) => {
                self.identify(Filter::all(), IdentifyOptions::MANY)
                    .await?
                    .stations
            }
            _ => answers,
        };
        let matching: Vec<&Station> = answered.iter().filter(fits).collect();
        match matching.as_slice() {
            [one] => Ok(Drive::new((*one).clone())),
            [] => Err(Error::NotFound {
                drive: drive.clone(),
                answered,
            }),
            several => Err(Error::Ambiguous {
                drive: drive.clone(),
                macs: several.iter().map(|station| station.mac).collect(),
            }),
        }
    }

    /// Asks the station of an address who it is: no other one has to answer. Empty where it does not say so at once.
    async fn ask_station(&mut self, mac: MacAddress) -> Result<Vec<Station>, Error> {
        let now = self.now();
        // an address of many stations is none of a drive
        let Ok(id) = self.client().controller().dcp_get(now, mac, &IDENTITY) else {
            return Ok(Vec::new());
        };
        let answer = self.wait(DIRECT_ANSWER, |client| client.take_dcp(id)).await?;
        if answer.is_none() {
            self.client().controller().cancel_dcp(id);
        }
        match answer {
            Some(Ok(DcpReply::Values(station))) => Ok(vec![station]),
            _ => Ok(Vec::new()),
        }
    }

    /// Returns the stations with the IP address of a drive; empty when discovery is not available.
    pub(super) async fn holders(&mut self, drive: &Drive) -> Result<Vec<MacAddress>, Error> {
        if !self.engine.discovers() {
            return Ok(Vec::new());
        }
        let answers = self.identify(Filter::all(), IdentifyOptions::MANY).await?;
        let same = answers
            .stations
            .iter()
            .filter(|station| station.ip.address == drive.station.ip.address);
        Ok(same.map(|station| station.mac).collect())
    }

    /// Without discovery only an address leads anywhere; who is there is learned from the endpoint mapper.
    async fn find_by_trust(&mut self, drive: &DriveAddress) -> Result<Drive, Error> {
        let DriveAddress::Ip(address) = drive else {
            return Err(Error::NeedsDiscovery { drive: drive.clone() });
        };
        let now = self.now();
        let query = self.client().ask_mapper(now, *address);
        let found = self
            .wait(MAPPER_LIMIT, |client| client.take_registered(query))
            .await?;
        let Some(Some(found)) = found else {
            return Err(Error::NotFound {
                drive: drive.clone(),
                answered: Vec::new(),
            });
        };
        Ok(Drive::new(Station {
            ip: IpSuite {
                address: *address,
                ..IpSuite::NONE
            },
            vendor_id: found.vendor_id,
            device_id: found.device_id,
            instance: found.instance,
            station_type: found.annotation,
            ..Station::default()
        }))
    }

    /// Gives a station its name.
    ///
    /// # Errors
    /// A name against the rules, or what the station answers.
    pub async fn set_name(&mut self, drive: &Drive, name: &str, permanent: bool) -> Result<(), Error> {
        self.set(drive, "setting the name", |client, now, mac| {
            client.controller().dcp_set_name(now, mac, name, permanent)
        })
        .await
    }

    /// Gives a station its address.
    ///
    /// # Errors
    /// An address against the rules, or what the station answers.
    pub async fn set_ip(&mut self, drive: &Drive, ip: IpSuite, permanent: bool) -> Result<(), Error> {
        self.set(drive, "setting the IP address", |client, now, mac| {
            client.controller().dcp_set_ip(now, mac, ip, permanent)
        })
        .await
    }

    /// Lets a station blink once, for about three seconds.
    ///
    /// # Errors
    /// What the station answers.
    pub async fn blink(&mut self, drive: &Drive) -> Result<(), Error> {
        self.set(drive, "blinking", |client, now, mac| {
            client.controller().dcp_signal(now, mac)
        })
        .await
    }

    /// Resets a station to factory values if it is not at work; `mode` as DCP ResetToFactory: 1 application,
    /// 2 communication, 3 engineering, 4 all data, 8 device. The connections of this session to it are closed first.
    ///
    /// # Errors
    /// [`Error::AtWork`] as [`check_idle`](Self::check_idle), and what the station answers.
    pub async fn reset(&mut self, drive: &mut Drive, mode: u8) -> Result<(), Error> {
        self.check_idle(drive, "reset").await?;
        self.reset_at_work(drive, mode).await
    }

    /// Resets a station whatever it is doing: a motor that turns coasts, and its controller loses it.
    ///
    /// # Errors
    /// What the station answers.
    pub async fn reset_at_work(&mut self, drive: &Drive, mode: u8) -> Result<(), Error> {
        self.close_to(drive).await?;
        self.set(drive, "resetting", |client, now, mac| {
            client.controller().dcp_reset(now, mac, mode)
        })
        .await
    }

    async fn set(
        &mut self,
        drive: &Drive,
        what: &'static str,
        start: impl FnOnce(&mut Client, Instant, MacAddress) -> Result<DcpId, Misuse>,
    ) -> Result<(), Error> {
        if drive.is_on_line() {
            let (drive, what) = (drive.label(), "name, IP address or signal");
            return Err(Error::NotOnLine { drive, what });
        }
        let now = self.now();
        let id = start(&mut self.client(), now, drive.station.mac)?;
        let done = self.wait(DCP_LIMIT, |client| client.take_dcp(id)).await;
        match Self::reached(drive, done)? {
            Some(Ok(DcpReply::Done | DcpReply::Values(_))) => Ok(()),
            Some(Err(error)) => Err(Error::Dcp {
                drive: drive.label(),
                what,
                error,
            }),
            None => Err(Error::Timeout {
                drive: drive.label(),
                what,
                limit: DCP_LIMIT,
            }),
        }
    }
}
