//! A plant in memory, opened like a network.

mod clock;
mod explained;

use std::path::Path;
use std::sync::Arc;

use client::{Client, ErrorKind, Session};
use network::system::Stop;
use plant::{PlantFileError, PlantPlan};
use profinet::controller::ControllerConfig;
use profinet::{IpSuite, MacAddress};

use crate::open::{Access, Network, OpenError, Opening, Place, Transport};
use crate::traffic::Traffic;

pub(crate) use clock::MOST_BEHIND;
use clock::{ByTheClock, Shared};

/// The address of this program in a plant. The drives have others: those of a file are locally administered ones made of
/// their names.
const MAC: MacAddress = MacAddress([0x02, 0x50, 0x4E, 0, 0, 0xC0]);

/// Opens a plant file: drives and what happens to them, in memory and in virtual time.
///
/// The network is of the same type as one of [`open`](crate::open()), and a program runs on both. Time advances only while a
/// call waits or an executor polls it, as fast as the computer can ([`Opening::in_real_time`] has the time of the clock). The time line of the file plays meanwhile, its controllers run, and cables lose
/// and delay frames as the file defines. One thread gets the same run every time; the seed in the file decides what happens by chance.
///
/// This program has the address [`PlantPlan::client_address`].
///
/// ```no_run
/// use profidrive::Wait;
///
/// let mut network = profidrive::open_plant("examples/plants/first.toml")?;
/// let drive = network.find(&"press-1".parse()?).wait()?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When the file cannot be read or something in it is not valid; with the file and the line.
pub fn open_plant(path: impl AsRef<Path>) -> Result<Network, OpenError> {
    open_plan(PlantPlan::read(path.as_ref())?)
}

/// Opens a plant that was read before, or is in the program as text: `open_plan(text.parse()?)`. See [`open_plant`].
///
/// # Errors
/// When no IP address is left beside its drives for this program.
pub fn open_plan(plant: PlantPlan) -> Result<Network, OpenError> {
    Opening::new(Access::default()).in_plant(plant).open()
}

/// The kind of the error: the content of the file, or the file itself.
pub(crate) const fn kind(error: &PlantFileError) -> ErrorKind {
    match error {
        PlantFileError::PlantPlan { .. } => ErrorKind::Usage,
        _ => ErrorKind::Local,
    }
}

impl Opening {
    /// In a plant in memory, in place of an interface; see [`open_plant`]. Of this and [`on`](Self::on) the last one applies. A
    /// plant carries everything, whatever the access and [`by_ip`](Self::by_ip).
    #[must_use]
    pub fn in_plant(mut self, plant: PlantPlan) -> Self {
        self.place = Place::Plant(Arc::new(plant));
        self
    }

    /// Lets the plant go on by the clock of this computer, in a thread of its own, whether calls wait or not: for people who
    /// watch it. Otherwise its time is virtual.
    #[must_use]
    pub const fn in_real_time(mut self) -> Self {
        self.real_time = true;
        self
    }
}

/// A plant that this program has joined.
///
/// ```
/// use std::time::Duration;
/// use profidrive::{Wait, Transport};
///
/// let plant = "[[drive]]\nname = \"akd-1\"\nip = \"10.0.0.1/24\"";
/// let mut network = profidrive::open_plan(plant.parse()?)?;
/// if let Transport::Plant(plant) = network.transport() {
///     let lasts = Some(Duration::from_millis(300));
///     let pulled = "cable=pulled".parse()?;
///     plant.with_world(|world| world.inject("akd-1", pulled, lasts))?;
/// }
/// # assert!(network.find(&"akd-1".parse()?).wait().is_ok(), "repeated after 300 ms");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Joined {
    plant: Shared,
    pub(crate) ip: IpSuite,
    traffic: Option<Traffic>,
}

impl Joined {
    /// Calls `work` with the plant, to look at its drives, to let something happen to them and to record the traffic. Nothing
    /// happens meanwhile: a call for the network inside of `work` would wait for ever.
    pub fn with_world<T>(&self, work: impl FnOnce(&mut plant::World) -> T) -> T {
        self.plant.with(work)
    }

    /// Starts this plant, or another one with the same address for this program, from its beginning, in the place of the one that runs.
    /// The time of the network goes on, and `session`, a caller on it, forgets the drives of the plant before with their
    /// connections ([`Session::forget_all`]): calls that wait for one end as if all drives were switched off at once.
    ///
    /// # Errors
    /// When a drive refuses its first parameters, or this program would need another address.
    pub fn restart(&self, plan: &PlantPlan, session: &mut Session) -> Result<(), OpenError> {
        let ip = plan.client_address()?;
        if ip != self.ip {
            return Err(OpenError::OtherAddress {
                now: self.ip.address,
                then: ip.address,
            });
        }
        let mut world = plant::World::new(plan)?;
        // before the new drives are there: none of them receives what is of a connection to another one
        session.forget_all();
        self.plant.replace(|base| {
            if let Some(traffic) = &self.traffic {
                world.add_tap(traffic.tap_since(base));
            }
            world
        });
        Ok(())
    }

    /// Lets the time of a plant that goes by the clock stand still, or go on. Meanwhile nothing moves and no call ends that waits for a
    /// drive.
    pub fn pause(&self, paused: bool) {
        self.plant.pause(paused);
    }

    /// Returns whether its time stands still.
    #[must_use]
    pub fn is_paused(&self) -> bool {
        self.plant.is_paused()
    }
}

/// A plant in virtual time that a program runs, looks at and joins with a network of its own when it needs one. Clones are the
/// same plant.
///
/// ```
/// use std::time::Duration;
/// use profidrive::plant::PlantPlan;
/// use profidrive::{Instant, Running, Wait};
///
/// let plant: PlantPlan = "[[drive]]\nname = \"akd-1\"\nip = \"10.0.0.1/24\"".parse()?;
/// let running = Running::start(plant)?;
/// running.with_world(|world| world.run_until(Instant::from_millis(500), &mut drop));
/// let mut network = running.join(None)?;
/// network.find(&"akd-1".parse()?).wait()?;
/// assert!(running.with_world(|world| world.now()) > Instant::from_millis(500));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Running {
    plan: Arc<PlantPlan>,
    plant: Shared,
}

impl Running {
    /// Returns the plant at its start.
    ///
    /// # Errors
    /// When a drive refuses its first parameters.
    pub fn start(plan: impl Into<Arc<PlantPlan>>) -> Result<Self, OpenError> {
        let plan = plan.into();
        let plant = Shared::new(plant::World::new(&plan)?);
        Ok(Self { plan, plant })
    }

    /// Returns the plan.
    #[must_use]
    pub const fn plan(&self) -> &Arc<PlantPlan> {
        &self.plan
    }

    /// Calls `work` with the plant. Where a network has joined it, nothing carries the calls of that network meanwhile: time is
    /// passed by [`Session::pass`](client::Session::pass) then.
    pub fn with_world<T>(&self, work: impl FnOnce(&mut plant::World) -> T) -> T {
        self.plant.with(work)
    }

    /// Joins the plant with a network, whose waiting calls advance virtual time; once.
    ///
    /// # Errors
    /// When no IP address is left beside its drives for this program.
    pub fn join(&self, stop: Option<Stop>) -> Result<Network, OpenError> {
        self.join_as(false, stop, None)
    }

    fn join_as(
        &self,
        real_time: bool,
        stop: Option<Stop>,
        traffic: Option<Traffic>,
    ) -> Result<Network, OpenError> {
        let ip = self.plan.client_address()?;
        // not that of a controller of the plant, which has the seed of the plant or one near it: both would give their connections the
        // same identifiers, and a drive refuses the second one
        let config = ControllerConfig::new(MAC, ip, "profidrive", !self.plan.seed);
        let plant = self.plant.clone();
        let network = if real_time {
            let start = |engine| ByTheClock::start(engine, plant.clone()).map_err(OpenError::Thread);
            client::Network::driven(Client::new(config), start)?
        } else {
            client::Network::on(plant.clone(), config).0
        };
        let network = network.simulated();
        let transport = Transport::Plant(Joined { plant, ip, traffic });
        Ok(Network::new(network, transport, stop))
    }
}

pub(crate) fn join(plan: &Arc<PlantPlan>, opening: &Opening) -> Result<Network, OpenError> {
    let running = Running::start(Arc::clone(plan))?;
    if let Some(traffic) = &opening.traffic {
        running.with_world(|world| world.add_tap(traffic.tap()));
    }
    running.join_as(opening.real_time, opening.stop.clone(), opening.traffic.clone())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::time::Duration;

    use client::{AxisSettings, ErrorKind, Wait};

    use super::*;
    use crate::DriveError;

    const TWO: &str = r#"
        seed = 3
        [[drive]]
        name = "akd-1"
        ip = "10.0.0.1/24"
        event = [
            { at = "0s", do = "loss=1%" },
            { at = "0s", do = "delay=2ms" },
            { at = "0s", do = "jitter=1ms" },
            { position = "1rev", do = "load=0.2Nm" },
            { at = "20s", do = "fault=439" },
        ]
        [[drive]]
        name = "far-1"
        ip = "10.0.9.1/24"
    "#;

    fn joined(network: &Network) -> Joined {
        match network.transport() {
            Transport::Plant(joined) => joined.clone(),
            transport => panic!("{transport:?}"),
        }
    }

    /// Runs the axis of the plant over a place, and returns what happened, and the trace.
    fn ride(seed: u64) -> (Vec<String>, u64) {
        let mut plant: PlantPlan = TWO.parse().unwrap();
        plant.seed = seed;
        let mut network = open_plan(plant).unwrap();
        let plant = joined(&network);
        let (sender, entries) = std::sync::mpsc::channel();
        plant.with_world(|world| {
            world.observe(move |entry| {
                let _ = sender.send(entry.to_string());
            });
        });
        let mut drive = network.find(&"akd-1".parse().unwrap()).wait().unwrap();
        let mut axis = network
            .take_axis(&mut drive, AxisSettings::default())
            .wait()
            .unwrap();
        let mut enabled = axis.enable().wait().unwrap();
        enabled.reach_speed(600.0, None).wait().unwrap();
        enabled.hold(Duration::from_secs(1)).wait().unwrap();
        let rest = Duration::from_secs(20);
        let fault = enabled.hold(rest).wait().unwrap_err();
        assert!(fault.to_string().contains("fault"), "{fault}");
        drop(enabled);
        // the fault leaves the motor to its friction, so it may turn yet
        let _ = axis.release().wait();
        let fault = plant.with_world(|world| world.drive(0).unwrap().drive().fault_number(0));
        assert_eq!(fault, 439);
        let hash = plant.with_world(|world| world.trace_hash());
        drop(network);
        (entries.try_iter().collect(), hash)
    }

    #[test]
    fn the_time_line_plays_while_calls_wait_and_the_seed_decides() {
        let (happened, hash) = ride(3);
        let at = |what: &str| {
            let line = happened.iter().find(|line| line.contains(what));
            let seconds = line.and_then(|line| line.split_whitespace().next());
            seconds.and_then(|seconds| seconds.parse::<f64>().ok())
        };
        assert!(at("! load=0.2Nm").is_some_and(|at| at < 5.0), "{happened:#?}");
        assert_eq!(at("! fault=439"), Some(20.0));
        assert_eq!(ride(3), (happened, hash));
        assert_ne!(ride(4).1, hash);
    }

    /// Its call is looked at when it is answered, not when the computer runs its thread again.
    #[test]
    fn a_call_takes_the_same_time_while_other_threads_wait() {
        let one = "[[drive]]\nname = \"akd-1\"\nip = \"10.0.0.1/24\"";
        let took = |waiting: usize| {
            let mut network = open_plan(one.parse().unwrap()).unwrap();
            let mut drive = network.find(&"akd-1".parse().unwrap()).wait().unwrap();
            let wanted = ["DRV.ACC".parse().unwrap()];
            let begin = network.now();
            let times = std::thread::scope(|scope| {
                for _ in 0..waiting {
                    let mut caller = network.clone();
                    scope.spawn(move || caller.pass(Duration::from_secs(20)).wait().unwrap());
                }
                let reader = async {
                    let mut times = Vec::new();
                    for _ in 0..50 {
                        let begin = network.now();
                        crate::parameters::read(&mut network, &mut drive, &wanted)
                            .await
                            .unwrap();
                        times.push(network.now() - begin);
                    }
                    times
                };
                reader.wait()
            });
            assert!(waiting == 0 || network.now() - begin >= Duration::from_secs(20));
            assert!(network.now() - begin < Duration::from_secs(20 * waiting as u64 + 2));
            times
        };
        // one that waits may let time pass between the look at it and the call, not during the call
        let usual = |mut times: Vec<Duration>| {
            times.sort();
            times[times.len() / 2]
        };
        let alone = usual(took(0));
        assert_eq!(usual(took(1)), alone);
        assert_eq!(usual(took(3)), alone);
    }

    /// Both find it free; the second connection would end the first one.
    #[test]
    fn of_two_callers_that_take_an_axis_at_once_one_has_it() {
        let one = "[[drive]]\nname = \"akd-1\"\nip = \"10.0.0.1/24\"";
        let mut network = open_plan(one.parse().unwrap()).unwrap();
        let mut drives = [(), ()].map(|()| network.find(&"akd-1".parse().unwrap()).wait().unwrap());
        let mut callers = [network.clone(), network.clone()];
        let taken = callers.iter_mut().zip(&mut drives);
        let taken = taken.map(|(caller, drive)| caller.take_axis(drive, AxisSettings::default()));
        let taken = futures::future::join_all(taken).wait();
        let [Ok(axis), Err(error)] = &taken[..] else {
            panic!("{taken:?}");
        };
        assert_eq!(
            error.to_string(),
            "akd-1: this program has its axis under control already"
        );
        network.pass(Duration::from_secs(1)).wait().unwrap();
        assert!(axis.lost().is_none());
    }

    /// The thread that computes is not inside of a wait.
    #[test]
    fn a_thread_between_two_calls_holds_up_no_other() {
        let one = "[[drive]]\nname = \"akd-1\"\nip = \"10.0.0.1/24\"";
        let mut network = open_plan(one.parse().unwrap()).unwrap();
        let mut caller = network.clone();
        network.pass(Duration::from_millis(10)).wait().unwrap();
        let passed = std::thread::spawn(move || caller.pass(Duration::from_secs(5)).wait());
        passed.join().unwrap().unwrap();
        network.pass(Duration::from_millis(10)).wait().unwrap();
        assert!(network.now() >= profinet::Instant::from_millis(5020));
    }

    #[test]
    fn something_can_happen_from_outside() {
        let mut network = open_plan(TWO.parse().unwrap()).unwrap();
        let plant = joined(&network);
        let mut drive = network.find(&"akd-1".parse().unwrap()).wait().unwrap();
        let inject = |drive: &str, what: &str| {
            plant.with_world(|world| world.inject(drive, what.parse().unwrap(), None))
        };
        inject("akd-1", "fault=439").unwrap();
        let faults = network.faults(&mut drive).wait().unwrap();
        assert_eq!(faults.first().map(|fault| fault.number), Some(439));
        let unknown = inject("akd-7", "fault=439").unwrap_err();
        assert_eq!(unknown.to_string(), "no drive `akd-7` in this plant");
        assert!(
            inject("akd-1", "fault=999")
                .unwrap_err()
                .to_string()
                .contains("no fault 999")
        );
    }

    #[test]
    fn a_drive_in_another_subnet_is_reported_as_on_a_wire() {
        let opening = Opening::new(Access::Records).in_plant(TWO.parse().unwrap());
        let (_network, drive) = opening.drive("akd-1", &mut |_| {}).wait().unwrap();
        assert_eq!(drive.label(), "akd-1");
        // the place that was given last
        let interface = opening.clone().on("no-such-interface");
        let error = interface.drive("akd-1", &mut |_| {}).wait().unwrap_err();
        assert!(error.to_string().contains("no-such-interface"), "{error}");
        let far = opening.drive("far-1", &mut |_| {}).wait().unwrap_err();
        assert!(matches!(far, DriveError::Subnet(_)), "{far}");
        let line = opening.drive("fc:ttyS7/1", &mut |_| {}).wait().unwrap_err();
        assert_eq!(line.kind(), ErrorKind::Usage, "{line}");
    }

    #[test]
    fn mistakes_in_a_plant_are_reported_with_their_place() {
        let file = std::env::temp_dir().join(format!("profidrive-plant-{}.toml", std::process::id()));
        std::fs::write(&file, "[[drive]]\nname = \"akd-1\"\nmodel = \"cvt\"\n").unwrap();
        let error = open_plant(&file).unwrap_err();
        std::fs::remove_file(&file).unwrap();
        assert_eq!(error.kind(), ErrorKind::Usage);
        let text = error.to_string();
        assert!(
            text.contains(".toml, line 3: no model `cvt`; there are: "),
            "{text}"
        );
        let missing = open_plant("no-such-plant.toml").unwrap_err();
        assert!(
            missing
                .to_string()
                .starts_with("cannot read no-such-plant.toml: "),
            "{missing}"
        );
        let full = "[[drive]]\nname = \"a\"\nip = \"10.0.0.1/31\"".parse().unwrap();
        assert_eq!(open_plan(full).unwrap_err().kind(), ErrorKind::Usage);
    }
}
