//! Which station is a drive of the machine, and its name and address.

use client::{Drive, Session};
use profile::model::Model;
use profinet::IpSuite;
use profinet::controller::Station;

use super::error::{CommissionError, ambiguous};
use crate::addressing::{self, NewAddress, NewName};
use crate::machine::MachineDrive;
use crate::report::{IpReport, NameReport};

/// Finds the station of a drive: by its MAC address where the file has one, else by its name.
pub(super) fn find<'s>(
    wanted: &MachineDrive,
    answered: &'s [Station],
) -> Result<&'s Station, CommissionError> {
    let (drive, line) = (wanted.name.clone(), wanted.line);
    let named: Vec<&Station> = answered
        .iter()
        .filter(|station| station.name == wanted.name)
        .collect();
    if named.len() > 1 {
        return Err(ambiguous(
            &drive,
            named.iter().map(|station| station.mac).collect(),
        ));
    }
    let mac = wanted.mac;
    let by_mac = answered.iter().find(|station| Some(station.mac) == mac);
    if let (Some(mac), Some(named)) = (mac, named.first().filter(|named| Some(named.mac) != mac)) {
        let found = named.mac;
        return Err(CommissionError::OtherStation {
            drive,
            line,
            mac,
            found,
        });
    }
    let station = by_mac.or(named.first().copied());
    let station = station.ok_or_else(|| CommissionError::NotFound { drive, line, mac })?;
    let model = Model::of(station.vendor_id, station.device_id);
    if model.key != wanted.model.key {
        return Err(CommissionError::OtherModel {
            drive: wanted.name.clone(),
            line,
            wanted: wanted.model.name,
            found: found_model(&model, station),
        });
    }
    Ok(station)
}

fn found_model(model: &Model, station: &Station) -> String {
    match model.catalogue {
        Some(_) => model.name.to_owned(),
        None => format!(
            "of vendor 0x{:04X}, device 0x{:04X}",
            station.vendor_id, station.device_id
        ),
    }
}

/// Returns whether a station has this address already. Without a gateway a station reports none, or its own address.
pub(super) fn has(station: &Station, wanted: IpSuite) -> bool {
    let gateway =
        |ip: IpSuite| Some(ip.gateway).filter(|gateway| !gateway.is_unspecified() && *gateway != ip.address);
    let ip = station.ip;
    (ip.address, ip.mask, gateway(ip)) == (wanted.address, wanted.mask, gateway(wanted))
}

/// Gives a station its name where it has another one.
pub(super) async fn name(
    session: &mut Session,
    drive: &mut Drive,
    wanted: &MachineDrive,
    dry_run: bool,
) -> Result<Option<NameReport>, CommissionError> {
    if drive.station.name == wanted.name {
        return Ok(None);
    }
    let new = NewName {
        dry_run,
        ..NewName::new(&wanted.name)
    };
    let report = addressing::set_name(session, drive, &new)
        .await
        .map_err(|error| CommissionError::at(wanted.line)(error.into()))?;
    if !dry_run {
        drive.station.name.clone_from(&wanted.name);
    }
    Ok(Some(report))
}

/// Gives a station its address where it has another one.
pub(super) async fn address(
    session: &mut Session,
    drive: &mut Drive,
    wanted: &MachineDrive,
    dry_run: bool,
) -> Result<Option<IpReport>, CommissionError> {
    let Some(ip) = wanted.ip.filter(|ip| !has(&drive.station, *ip)) else {
        return Ok(None);
    };
    let new = NewAddress {
        dry_run,
        ..NewAddress::new(ip)
    };
    let report = addressing::set_ip(session, drive, &new)
        .await
        .map_err(|error| CommissionError::at(wanted.line)(error.into()))?;
    if !dry_run {
        drive.station.ip = ip;
    }
    Ok(Some(report))
}
