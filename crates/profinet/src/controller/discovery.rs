//! DCP requests of a controller.

use super::Controller;
use super::dcp::{Filter, IdentifyOptions, Setting};
use super::error::Misuse;
use super::event::{DcpId, Event};
use crate::wire::dcp::{DcpOption, Qualifier, check_ip, check_name};
use crate::{Instant, IpSuite, MacAddress};

/// Discovery and basic configuration.
impl Controller {
    /// Searches for stations, for 400 ms if one name is requested, else for 1 s with spread answers.
    ///
    /// # Errors
    /// When the name is illegal or too many requests are open.
    pub fn identify(&mut self, now: Instant, filter: Filter) -> Result<DcpId, Misuse> {
        let one = filter.name.is_some() || filter.alias.is_some() || filter.mac.is_some();
        let options = if one {
            IdentifyOptions::ONE
        } else {
            IdentifyOptions::MANY
        };
        self.identify_with(now, filter, options)
    }

    /// Returns the same with a window of the caller's choice.
    ///
    /// # Errors
    /// When the name exceeds the maximum length, or too many requests are open. A search for an invalid name is
    /// allowed, as a station may use one.
    pub fn identify_with(
        &mut self,
        now: Instant,
        filter: Filter,
        options: IdentifyOptions,
    ) -> Result<DcpId, Misuse> {
        let too_long = [&filter.name, &filter.alias, &filter.station_type];
        if too_long.into_iter().flatten().any(|text| text.len() > 255) {
            return Err(Misuse::Range("length of the filter"));
        }
        self.dcp
            .identify(now, filter, options)
            .ok_or(Misuse::TooMany("DCP requests"))
    }

    /// Ends an Identify, Get or Set request; no further event will come for it.
    pub fn cancel_dcp(&mut self, id: DcpId) {
        self.dcp.cancel(id);
        self.events.retain(|event| {
            !matches!(event, Event::Identified { id: other, .. } | Event::IdentifyDone { id: other, .. }
                | Event::DcpDone { id: other, .. } if *other == id)
        });
    }

    /// Reads settings of the station `mac`. As in an answer to Identify, what it does not have is empty; where it has none of
    /// the options the result is an error.
    ///
    /// # Errors
    /// When the address is not a station's, or too many requests are open.
    pub fn dcp_get(&mut self, now: Instant, mac: MacAddress, options: &[DcpOption]) -> Result<DcpId, Misuse> {
        if options.is_empty() || options.len() > 64 {
            return Err(Misuse::Range("number of options"));
        }
        unicast(mac)?;
        self.dcp
            .get(now, mac, options.to_vec())
            .ok_or(Misuse::TooMany("DCP requests"))
    }

    /// Sets the name of the station `mac`, permanently or until power-off. An empty name deletes it.
    ///
    /// # Errors
    /// When the name breaks a rule, the address is not a station's, or too many requests are open.
    pub fn dcp_set_name(
        &mut self,
        now: Instant,
        mac: MacAddress,
        name: &str,
        permanent: bool,
    ) -> Result<DcpId, Misuse> {
        if !name.is_empty() {
            check_name(name.as_bytes())?;
        }
        self.set(now, mac, Setting::Name(qualifier(permanent)), Some(name))
    }

    /// Sets the IP configuration of the station `mac`, permanently or until power-off. All zero deletes it.
    ///
    /// # Errors
    /// When the configuration breaks a rule, the address is not a station's, or too many requests are open.
    pub fn dcp_set_ip(
        &mut self,
        now: Instant,
        mac: MacAddress,
        ip: IpSuite,
        permanent: bool,
    ) -> Result<DcpId, Misuse> {
        check_ip(&ip)?;
        self.set(now, mac, Setting::Ip(qualifier(permanent), ip), None)
    }

    /// Lets the station `mac` blink.
    ///
    /// # Errors
    /// When the address is not a station's, or too many requests are open.
    pub fn dcp_signal(&mut self, now: Instant, mac: MacAddress) -> Result<DcpId, Misuse> {
        self.set(now, mac, Setting::Signal, None)
    }

    /// Resets the station `mac`: mode 1 application data, 2 communication parameters, 3 engineering, 4 all stored
    /// data, 8 device, 9 reset and restore; mode 0 is the old form without mode, which resets everything.
    ///
    /// # Errors
    /// When there is no such mode, the address is not a station's, or too many requests are open.
    pub fn dcp_reset(&mut self, now: Instant, mac: MacAddress, mode: u8) -> Result<DcpId, Misuse> {
        let setting = match mode {
            0 => Setting::LegacyReset,
            1..=4 | 8 | 9 => Setting::Reset(Qualifier::reset(mode)),
            _ => return Err(Misuse::Range("reset mode")),
        };
        self.set(now, mac, setting, None)
    }

    fn set(
        &mut self,
        now: Instant,
        mac: MacAddress,
        setting: Setting,
        name: Option<&str>,
    ) -> Result<DcpId, Misuse> {
        unicast(mac)?;
        self.dcp
            .set(now, mac, setting, name.map(Into::into))
            .ok_or(Misuse::TooMany("DCP requests"))
    }
}

/// All other requests address one station.
pub(super) fn unicast(mac: MacAddress) -> Result<(), Misuse> {
    if mac.is_multicast() || mac == MacAddress::default() {
        Err(Misuse::Address(mac))
    } else {
        Ok(())
    }
}

const fn qualifier(permanent: bool) -> Qualifier {
    if permanent {
        Qualifier::PERMANENT
    } else {
        Qualifier::TEMPORARY
    }
}
