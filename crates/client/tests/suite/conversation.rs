//! Whole conversations under attack, in virtual time: a client runs an axis and reads its parameters, while a hostile
//! station sends what it saw on the network, changed, repeated and in another order. It has addresses of its own, or
//! those of another drive and its controllers. The axis goes on, each answer belongs to its request, memory is bounded,
//! and no connection outlives its watchdog.
//!
//! `PROFIDRIVE_CONVERSATIONS` is how many conversations there are, `PROFIDRIVE_SEED` the first of them. A failure prints
//! the seed.

// helpers of tests fail by panicking, like the tests themselves
#![allow(clippy::panic)]

use std::net::Ipv4Addr;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::PoisonError;
use std::time::Duration;

use allocations::kept_by;
use futures::future::{join_all, join3, select as first};
use network::host::{Host, StationId};
use network::segment::Conditions;
use profidrive_client::axis::Purpose;
use profidrive_client::{Client, Drive, DriveAddress, Session, Wait};
use profinet::controller::{ControllerConfig, Resolve};
use profinet::device::Stored;
use profinet::{Instant, IpSuite, MacAddress};
use testbench::attack::{Attacker, Party, Plan, Random, Recorder, Role, foreign};
use testbench::{Bench, bench_of, drive_at, ip, plc, running_on, select};
use virtual_drive::model::{self, Model};
use virtual_drive::station::{Station, StationConfig};

const SECOND: Duration = Duration::from_secs(1);
const SPEED: f64 = 300.0;
/// How many conversations an ordinary run has.
const CONVERSATIONS: u64 = 100;
/// Frames of an attack, and how long it takes at most.
const FRAMES: u32 = 1500;
const ATTACK: Duration = Duration::from_secs(2);
/// What drives, client and segment may keep of an attack.
const MOST_KEPT: i64 = 256 << 10;

/// A model and parameters of it that differ.
const SUBJECTS: [(&Model, [&str; 4]); 3] = [
    (&model::AKD, ["DRV.ACC", "VL.LIMITP", "IL.KP", "MOTOR.POLES"]),
    (&model::VLT, ["3-41", "3-03", "1-20", "4-14"]),
    (&model::VACON, ["ID 103", "ID 102", "ID 111", "ID 600"]),
];

const fn party(last: u8, mac: [u8; 2]) -> Party {
    Party {
        mac: MacAddress([2, 0, 0, 0, mac[0], mac[1]]),
        ip: Ipv4Addr::new(10, 0, 0, last),
    }
}

/// The drive that must not be disturbed.
const GOOD: Party = party(1, [0, 1]);
/// The drive in whose name the attacker speaks too.
const BAD: Party = party(2, [0, 2]);
const CLIENT: Party = party(200, [1, 0]);
/// The controller of the bad drive.
const PLC: Party = party(201, [1, 1]);

fn station(model: &'static Model, name: &str, party: Party) -> Box<Host<Station>> {
    let mut config = StationConfig::new(model, party.mac);
    let last = party.ip.octets()[3];
    config.network = Stored {
        name: name.into(),
        ip: ip(last),
        ..Stored::default()
    };
    Box::new(Host::new(Station::new(config)))
}

/// A controller that exchanges data with the bad drive.
fn controller(model: &'static Model) -> Box<Host<Client>> {
    let config = ControllerConfig::new(PLC.mac, ip(201), "plc", 2);
    let mut client = Client::new(config);
    let target = plc::target(model, "bad", None, IpSuite::NONE);
    let connection = plc::connection(model, 1, Resolve::Check);
    client
        .controller()
        .connect(Instant::ZERO, target, connection)
        .expect("a request");
    Box::new(Host::new(client))
}

/// Everybody whom the attacker plays.
fn roles() -> Vec<Role> {
    let foreign = (0..4).map(foreign).flat_map(|from| {
        [GOOD, BAD, CLIENT, PLC].map(|to| Role {
            from,
            to,
            to_all: true,
        })
    });
    let others = [(BAD, CLIENT), (BAD, PLC), (CLIENT, BAD), (PLC, BAD)];
    // as likely as the foreign ones
    let others = others.into_iter().cycle().take(16).map(|(from, to)| Role {
        from,
        to,
        to_all: false,
    });
    foreign.chain(others).collect()
}

/// Reads these parameters at once; whole numbers as they are on the wire.
async fn raw(session: &Session, drive: &Drive, names: &[&str]) -> Vec<Option<i64>> {
    let reads = names.iter().map(|name| {
        let (mut session, mut drive) = (session.clone(), drive.clone());
        let selection = select(&drive, name);
        async move {
            let reading = session.read_one(&mut drive, &selection).await;
            reading.ok().and_then(|reading| reading.raw())
        }
    });
    join_all(reads).await
}

fn exchanging(network: &Bench, id: StationId) -> bool {
    drive_at(network, id).device().is_exchanging()
}

/// What happened in some conversations.
#[derive(Debug, Default)]
struct Tally {
    /// Frames of the attacker.
    sent: u64,
    /// Frames that foreign stations got for theirs.
    answered: u64,
    /// Parameters of the good drive that were read meanwhile.
    read: u64,
    /// How often the good drive was found meanwhile.
    found: u64,
    /// Conversations in which the connection of the bad drive ended.
    ended: u64,
    /// The most octets that one attack left.
    kept: i64,
}

/// Begins an attack; on the way to these stations frames are lost, repeated and out of order too.
fn attack(
    network: &Bench,
    seed: u64,
    frames: Vec<Vec<u8>>,
    roles: Vec<Role>,
    spoiled: [StationId; 2],
) -> StationId {
    let plan = Plan {
        seed,
        frames,
        roles,
        spared: GOOD,
        start: network.now(),
        count: FRAMES,
    };
    let conditions = Conditions {
        loss: 0.02,
        duplicate: 0.1,
        reorder: 0.1,
        reorder_by: Duration::from_millis(2),
        ..Conditions::default()
    };
    let mut medium = network.medium();
    let segment = medium.segment_mut();
    for id in spoiled {
        segment.set_conditions(id, conditions);
    }
    segment.attach(Box::new(Attacker::new(plan)))
}

fn conversation(seed: u64, tally: &mut Tally) {
    let mut random = Random::new(seed);
    let (good_model, good_names) = SUBJECTS[random.below(3) as usize];
    let (bad_model, bad_names) = SUBJECTS[random.below(3) as usize];
    let (network, ids) = bench_of(vec![
        station(good_model, "good", GOOD),
        station(bad_model, "bad", BAD),
    ]);
    let (good_id, bad_id) = (ids[0], ids[1]);
    let recorder = Recorder::shared();
    let plc_id = {
        let mut medium = network.medium();
        let segment = medium.segment_mut();
        segment.add_tap(Box::new(recorder.clone()));
        segment.attach(controller(bad_model))
    };
    let mut session = Session::clone(&network);
    let find = |name: &str| {
        let address: DriveAddress = name.parse().expect("an address");
        session.find(&address).wait().expect("there")
    };
    let [mut good, bad] = ["good", "bad"].map(find);
    session.pass(SECOND * 3).wait().expect("the controller connects");
    assert!(exchanging(&network, bad_id), "it has its controller");
    let expected = raw(&session, &good, &good_names).wait();
    assert!(expected.iter().all(Option::is_some), "{expected:?}");
    raw(&session, &bad, &bad_names).wait();
    let mut axis = session
        .take_axis(&mut good, running_on(Purpose::Speed))
        .wait()
        .expect("connected");
    let mut enabled = axis.enable().wait().expect("enabled");
    enabled.reach_speed(SPEED, None).wait().expect("turns");
    assert_eq!(raw(&session, &good, &good_names).wait(), expected);

    let seen = recorder.lock().unwrap_or_else(PoisonError::into_inner).stop();
    let attacker = attack(&network, seed, seen.clone(), roles(), [bad_id, plc_id]);
    let ((), kept) = kept_by(|| {
        let undisturbed = Box::pin(async {
            let kept = enabled.keep_speed(SPEED, ATTACK).await;
            kept.unwrap_or_else(|error| panic!("the axis: {error}"));
        });
        let reads = async {
            loop {
                let values = raw(&session, &good, &good_names).await;
                assert_eq!(values, expected, "each answer belongs to its request");
                tally.read += values.len() as u64;
                session.clone().pass(SECOND / 50).await.expect("time passes");
            }
        };
        let finds = async {
            let address = DriveAddress::Mac(GOOD.mac);
            loop {
                let found = session.clone().find(&address).await;
                let found = found.unwrap_or_else(|error| panic!("the good drive: {error}"));
                let station = &found.station;
                assert_eq!((&*station.name, station.mac), ("good", GOOD.mac));
                assert_eq!(station.ip.address, GOOD.ip);
                tally.found += 1;
            }
        };
        // what it says is the attacker's too
        let others = async {
            loop {
                raw(&session, &bad, &bad_names).await;
                session.clone().pass(SECOND / 50).await.expect("time passes");
            }
        };
        let beside = Box::pin(join3(reads, finds, others));
        // the readers never end by themselves
        let _ = first(undisturbed, beside).wait();
    });
    assert!(kept < MOST_KEPT, "{kept} octets are kept");
    tally.kept = tally.kept.max(kept);
    tally.ended += u64::from(!exchanging(&network, bad_id));
    assert!(exchanging(&network, good_id));
    assert!((drive_at(&network, good_id).drive().axis().speed() - SPEED).abs() < 10.0);
    drop(enabled);
    axis.release().wait().expect("in order");
    assert_eq!(raw(&session, &good, &good_names).wait(), expected);

    // a connection begins while others attack the client; the drive itself is free for every station
    let aside = roles().into_iter().filter(|role| role.to != GOOD);
    let aside = aside.map(|role| Role {
        to_all: false,
        ..role
    });
    let again = attack(&network, !seed, seen, aside.collect(), [bad_id, plc_id]);
    let mut axis = session
        .take_axis(&mut good, running_on(Purpose::Speed))
        .wait()
        .expect("connected under attack");
    let mut enabled = axis.enable().wait().expect("enabled under attack");
    enabled.reach_speed(SPEED, None).wait().expect("turns");
    assert_eq!(raw(&session, &good, &good_names).wait(), expected);
    drop(enabled);
    axis.release().wait().expect("in order");

    // nothing keeps a connection alive whose controller is gone: three cycles of 16 ms
    {
        let mut medium = network.medium();
        let segment = medium.segment_mut();
        for attacker in [attacker, again] {
            tally.sent += segment.station::<Attacker>(attacker).map_or(0, Attacker::sent);
            segment.detach(attacker);
        }
        segment.detach(plc_id);
    }
    tally.answered += recorder.lock().unwrap_or_else(PoisonError::into_inner).answers();
    session.pass(SECOND / 10).wait().expect("time passes");
    assert!(!exchanging(&network, bad_id) && !exchanging(&network, good_id));
}

fn setting(name: &str, otherwise: u64) -> u64 {
    let given = std::env::var(name).ok();
    given.map_or(otherwise, |text| text.parse().expect("a number"))
}

#[test]
fn an_axis_and_its_answers_survive_an_attack_by_other_stations() {
    let begin = setting("PROFIDRIVE_SEED", 1);
    let count = setting("PROFIDRIVE_CONVERSATIONS", CONVERSATIONS);
    let mut tally = Tally::default();
    for seed in begin..begin + count {
        let tally = AssertUnwindSafe(&mut tally);
        let played = catch_unwind(move || conversation(seed, { tally }.0));
        if let Err(panic) = played {
            eprintln!("PROFIDRIVE_SEED={seed} PROFIDRIVE_CONVERSATIONS=1");
            resume_unwind(panic);
        }
    }
    println!("{count} conversations: {tally:?}");
    // the attack reaches what it is aimed at; of a few seeds that is not certain
    if count >= CONVERSATIONS {
        assert!(
            tally.sent > count * 1000 && tally.answered > count * 10,
            "{tally:?}"
        );
        assert!(tally.read > count * 100 && tally.found >= count, "{tally:?}");
        assert!(tally.ended > 0, "{tally:?}");
    }
}
