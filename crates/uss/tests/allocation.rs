//! A telegram costs no allocation, neither on the line nor in the parameter channel.

use std::time::Duration;

use allocations::made_by as allocations;
use profidrive_uss::{
    Address, Layout, MAX_DATA, MAX_TELEGRAM, Master, MasterConfig, Parts, Slave, SlaveConfig,
};
use profile::parameter::{Attributes, ErrorNumber, Format, Keep, ParameterAccess};
use profile::pkw::{Client, ClientTiming, Job, MAX_BLOCK, PkwDialect, Server};

struct Drive;

impl ParameterAccess for Drive {
    fn attributes(&self, _: u16, _: u16) -> Option<Attributes> {
        Some(Attributes::simple(Format::UNSIGNED16, 2, true))
    }

    fn read(&mut self, pnu: u16, _: u16) -> Result<u64, ErrorNumber> {
        Ok(pnu.into())
    }

    fn write(&mut self, _: u16, _: u16, _: u64, _: Keep) -> Result<(), ErrorNumber> {
        Ok(())
    }
}

#[test]
fn telegrams_and_requests_allocate_nothing() {
    let mut master = Master::new(MasterConfig::fc(19_200));
    let id = master.add(Address::fc(1).unwrap(), &[0; 12]).unwrap();
    let mut slave = Slave::new(SlaveConfig::fc(1, 19_200));
    let mut server = Server::new(PkwDialect::DANFOSS_FC);
    let mut client = Client::new(PkwDialect::DANFOSS_FC, ClientTiming::SERIAL);
    let mut now = Duration::from_secs(1);
    let mut answered = 0;
    let mut run = |rounds: u32| {
        let (mut out, mut pkw, mut data) = ([0; MAX_TELEGRAM], [0; MAX_BLOCK], [0; MAX_DATA]);
        for round in 0..rounds {
            if !client.is_busy() {
                let pnu = 1 + (round % 7) as u16;
                client.start(now, Job::Read { pnu, element: None }).unwrap();
            }
            let parts = Parts {
                pkw: client.request(now),
                pzd: &[0; 4],
            };
            let length = Layout::FC.join(parts, &mut data).unwrap();
            master.set_data(id, &data[..length]).unwrap();
            now = now.max(master.poll_timeout().unwrap());
            let length = master.poll_transmit(now, &mut out).unwrap();
            slave.handle_octets(now, &out[..length]);
            now = slave.poll_timeout().unwrap();
            slave.handle_timeout(now);
            let request = slave.poll_request().unwrap();
            let parts = Layout::FC.split(request.data).unwrap();
            let length = server.handle_block(parts.pkw, &mut Drive, &mut pkw).unwrap();
            let parts = Parts {
                pkw: &pkw[..length],
                pzd: &[0x06, 0x03, 0, 0],
            };
            let length = Layout::FC.join(parts, &mut data).unwrap();
            slave.respond(&data[..length]).unwrap();
            let length = slave.poll_transmit(now, &mut out).unwrap();
            master.handle_octets(now, &out[..length]);
            now = master.poll_timeout().unwrap();
            master.handle_timeout(now);
            assert!(master.poll_event().is_some());
            let reply = Layout::FC.split(master.reply(id)).unwrap();
            answered += u32::from(client.handle(now, reply.pkw).is_some());
        }
    };
    run(10);
    assert_eq!(allocations(|| run(1000)), 0);
    assert!(answered > 400, "{answered}");
}
