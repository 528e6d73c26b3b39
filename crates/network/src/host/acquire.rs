//! How a station that has no address finds one: DHCP, and while no server answers a link-local address.

use std::net::Ipv4Addr;
use std::time::Duration;

use profinet::{Instant, IpSuite, MacAddress};
use smoltcp::wire::{ArpPacket, ArpRepr};

use super::dhcp::Dhcp;
use super::link_local::{ArpAddresses, LinkLocal, Step};

/// Time during which only DHCP is tried. Own choice: no source states how long an AKD waits.
const DHCP_TIMEOUT: Duration = Duration::from_secs(5);

/// What the stack has to do.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Action {
    /// Send this frame.
    Send(Vec<u8>),
    /// Send an ARP probe for this address.
    Probe(Ipv4Addr),
    /// Announce the address in use.
    Announce,
    /// This is the address of the station now, [`IpSuite::NONE`]: none.
    Use(IpSuite),
}

/// Acquires an address, then defends and renews it.
#[derive(Debug)]
pub(super) struct Acquire {
    mac: MacAddress,
    dhcp: Dhcp,
    leased: bool,
    /// From when on a link-local address is looked for.
    fall_back: Option<Instant>,
    link_local: Option<LinkLocal>,
}

impl Acquire {
    /// Starts to look for an address.
    pub fn new(now: Instant, mac: MacAddress) -> Self {
        Self {
            mac,
            dhcp: Dhcp::new(now, mac),
            leased: false,
            fall_back: Some(now + DHCP_TIMEOUT),
            link_local: None,
        }
    }

    /// Takes a received frame with ARP or IPv4.
    pub fn handle_frame(&mut self, now: Instant, frame: &[u8], payload: &[u8]) {
        self.dhcp.handle_frame(frame);
        let Some(link_local) = &mut self.link_local else {
            return;
        };
        let packet = ArpPacket::new_checked(payload);
        let message = packet.and_then(|packet| ArpRepr::parse(&packet));
        if let Ok(ArpRepr::EthernetIpv4 {
            source_hardware_addr,
            source_protocol_addr,
            target_protocol_addr,
            ..
        }) = message
        {
            let packet = ArpAddresses {
                mac: MacAddress(source_hardware_addr.0),
                sender: source_protocol_addr,
                target: target_protocol_addr,
            };
            link_local.receive(now, packet);
        }
    }

    /// Returns the actions that are due now.
    pub fn poll(&mut self, now: Instant) -> Option<Action> {
        if let Some(frame) = self.dhcp.poll_transmit() {
            return Some(Action::Send(frame));
        }
        match self.dhcp.poll(now) {
            Some(Some(suite)) => {
                self.leased = true;
                self.link_local = None;
                self.fall_back = None;
                return Some(Action::Use(suite));
            }
            Some(None) if self.leased => {
                self.leased = false;
                self.fall_back = Some(now + DHCP_TIMEOUT);
                return Some(Action::Use(IpSuite::NONE));
            }
            _ => {}
        }
        if let Some(frame) = self.dhcp.poll_transmit() {
            return Some(Action::Send(frame));
        }
        if self.fall_back.take_if(|due| *due <= now).is_some() {
            self.link_local = Some(LinkLocal::new(now, self.mac));
        }
        Some(match self.link_local.as_mut()?.poll(now)? {
            Step::Probe(address) => Action::Probe(address),
            Step::Use(suite) => Action::Use(suite),
            Step::Defend(_) => Action::Announce,
            Step::GiveUp => Action::Use(IpSuite::NONE),
        })
    }

    /// Returns the time when [`poll`](Self::poll) has something to do.
    pub fn poll_timeout(&self) -> Option<Instant> {
        let link_local = self.link_local.as_ref().and_then(LinkLocal::poll_timeout);
        Instant::earliest([self.dhcp.poll_timeout(), self.fall_back, link_local])
    }
}
