//! How much faster than real time one drive is positioned, its axis stepped every millisecond: with every frame through
//! controller, segment and device, and the drive alone, ticked as its cycle would.

use std::fmt::Write;
use std::time::{Duration, Instant as Wall};

use plant::{PlantPlan, World};
use profinet::Instant;
use virtual_drive::drive::Drive;
use virtual_drive::model;

use crate::table::Row;

/// Update time of the connection.
const CYCLE: Duration = Duration::from_millis(16);
/// Virtual time measured.
const SPAN: Duration = Duration::from_secs(600);
/// From one task to the next.
const TASK_SECONDS: u64 = 2;
const ROUNDS: usize = 5;

const WITH_WIRE: f64 = 12_000.0;
const SINGLE_LIMIT: f64 = 20_000.0;
/// Drives of a large plant, and of a small one that it is compared with.
const MANY: usize = 100;
const FEW: usize = 10;
/// How much longer a drive of the large plant may take: what is not in the nearest cache any more.
const LINEAR: f64 = 1.25;
/// How much faster two plants are on two cores than one after the other.
const TWO: f64 = 1.8;

/// Both, each the best of a few rounds: what disturbs a round makes it slower, never faster.
pub fn compare() -> Vec<Row> {
    let plant: PlantPlan = plant(1, SPAN).parse().unwrap();
    let best = |round: &dyn Fn() -> f64| (0..ROUNDS).map(|_| round()).fold(0.0, f64::max);
    let row = |what: &str, factor: f64, limit: f64| {
        Row::new(what, format!("{factor:.0} times real time"))
            .limit(format!("{limit:.0} times"), factor >= limit)
    };
    vec![
        row(
            "positioning with every frame on the wire",
            best(&|| on_the_wire(&plant)),
            WITH_WIRE,
        ),
        row("positioning, the drive alone", best(&single), SINGLE_LIMIT),
        linear(),
        two_cores(),
    ]
}

/// A large plant beside a small one.
fn linear() -> Row {
    let span = SPAN / 10;
    let [few, many] = [FEW, MANY].map(|count| {
        let plant = plant(count, span).parse().unwrap();
        let best = (0..ROUNDS).map(|_| run(&plant, span).1).min().unwrap();
        best.as_secs_f64() * 1e6 * CYCLE.as_secs_f64() / (span.as_secs_f64() * count as f64)
    });
    Row::new(
        &format!("a cycle of a drive in a plant of {MANY}, with every frame"),
        format!("{many:.2} us"),
    )
    .beside(format!("{few:.2} us in a plant of {FEW}"))
    .limit(format!("{:.2} us", LINEAR * few), many <= LINEAR * few)
}

/// Two plants on two threads, and the same two one after the other.
fn two_cores() -> Row {
    let plant: PlantPlan = plant(1, SPAN).parse().unwrap();
    let rounds = (0..ROUNDS).map(|_| {
        let begin = Wall::now();
        for _ in 0..2 {
            run(&plant, SPAN);
        }
        let one_after_the_other = begin.elapsed();
        let begin = Wall::now();
        std::thread::scope(|scope| {
            for _ in 0..2 {
                scope.spawn(|| run(&plant, SPAN));
            }
        });
        one_after_the_other.as_secs_f64() / begin.elapsed().as_secs_f64()
    });
    let factor = rounds.fold(0.0, f64::max);
    Row::new("two plants on two cores", format!("{factor:.2} times as fast"))
        .beside("one after the other".into())
        .limit(format!("{TWO} times"), factor >= TWO)
}

/// Drives that go to and fro by MDI with telegram 9: ten revolutions at 600 rpm.
fn plant(count: usize, span: Duration) -> String {
    (1..=count).map(|number| drive(number, span)).collect()
}

fn drive(number: usize, span: Duration) -> String {
    let mut text = format!(
        r#"
[[drive]]
name = "akd-{number}"
ip = "10.0.0.{number}/24"
parameters = {{ 930 = 2 }}
[[controller]]
drive = "akd-{number}"
telegram = 9
step = [
    {{ at = "0.2s", send = {{ STW1 = "0x0436", SATZANW = "0x8000", MDI_VELOCITY = "600rpm", MDI_MOD = 1 }} }},
    {{ at = "0.2s", send = {{ MDI_ACC = 50, MDI_DEC = 50 }} }},
    {{ at = "0.4s", send = {{ STW1 = "0x043F" }} }},
    {{ at = "0.6s", send = {{ STW1 = "0x0C3F" }} }},
    {{ at = "0.8s", send = {{ STW1 = "0x043F" }} }},
"#,
    );
    for task in 0..span.as_secs() / TASK_SECONDS {
        let (target, at) = (if task % 2 == 0 { 655_360 } else { 0 }, 1 + task * TASK_SECONDS);
        writeln!(
            text,
            r#"{{ at = "{at}s", send = {{ MDI_TARPOS = "0x{target:X}", STW1 = "0x047F" }} }},"#
        )
        .unwrap();
        writeln!(text, r#"{{ at = "{at}.5s", send = {{ STW1 = "0x043F" }} }},"#).unwrap();
    }
    text + "]\n"
}

fn on_the_wire(plant: &PlantPlan) -> f64 {
    let (world, took) = run(plant, SPAN);
    let drive = world.drive(0).unwrap().drive();
    assert!(
        drive.is_enabled() && !drive.has_fault(),
        "it was positioned to the end"
    );
    let travelled = drive.axis().position().unsigned_abs() >> 32;
    assert!(travelled <= 10, "between the two ends, not {travelled} rev away");
    SPAN.as_secs_f64() / took.as_secs_f64()
}

/// Returns a plant at its end, and how long it took.
fn run(plant: &PlantPlan, span: Duration) -> (World, Duration) {
    let mut world = World::new(plant).unwrap();
    let begin = Wall::now();
    world.run_until(Instant::ZERO + span, &mut drop);
    (world, begin.elapsed())
}

fn single() -> f64 {
    let mut drive = Drive::new(&model::AKD);
    let position_mode = [1, 2, 0, 1, 0x10, 1, 0x03, 0xA2, 0, 0, 0x42, 1, 0, 2];
    drive.serve(&position_mode, &mut [0; 240]).unwrap();
    drive.connect(9, 3 * CYCLE).unwrap();
    let mut outputs = [0; 20];
    outputs[2] = 0x80; // SATZANW: MDI
    outputs[10..14].copy_from_slice(&0x0CCC_CCCD_u32.to_be_bytes()); // MDI_VELOCITY 600 rpm
    outputs[14..20].copy_from_slice(&[0, 50, 0, 50, 0, 1]); // MDI_ACC, MDI_DEC, MDI_MOD
    let mut inputs = [0; 10];
    let mut now = Instant::ZERO;
    let mut tick = |drive: &mut Drive, control: u16, target: i32| {
        now += CYCLE;
        outputs[..2].copy_from_slice(&control.to_be_bytes());
        outputs[6..10].copy_from_slice(&target.to_be_bytes());
        drive.tick(now, Some(&outputs), &mut inputs);
        u16::from_be_bytes([inputs[0], inputs[1]])
    };
    for control in [0x0436, 0x0437, 0x043F, 0x0C3F, 0x043F] {
        for _ in 0..20 {
            tick(&mut drive, control, 0);
        }
    }
    let (mut status, mut reached) = (0_u16, 0_u32);
    let begin = Wall::now();
    let ticks = u32::try_from(SPAN.as_nanos() / CYCLE.as_nanos()).unwrap();
    for _ in 0..ticks {
        let start = status & 0x1400 == 0x0400; // target reached, last task no longer acknowledged
        reached += u32::from(start);
        let target = if reached % 2 == 1 { 10 << 16 } else { 0 };
        status = tick(&mut drive, if start { 0x047F } else { 0x043F }, target);
    }
    let factor = SPAN.as_secs_f64() / begin.elapsed().as_secs_f64();
    assert!(reached > 300, "{reached} movements");
    factor
}
