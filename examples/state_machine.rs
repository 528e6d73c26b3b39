//! The general state machine: the start-up sequences of the AKD manual, word by word.
//!
//! `cargo run -p examples --example state_machine`

use profile::state::{Inputs, Machine, Stw1};

fn main() {
    for (title, words) in [
        ("5.9", [0x0470, 0x0476, 0x0477, 0x047F]),
        ("7.1.4", [0x0400, 0x0406, 0x040E, 0x040F]),
    ] {
        println!("AKD manual {title}");
        let mut machine = Machine::new();
        for word in words {
            let inputs = Inputs {
                stw1: Stw1(word),
                standstill: true,
                ..Inputs::default()
            };
            let output = machine.step(&inputs);
            println!(
                "  STW1 0x{word:04X} -> {}, ZSW1 0x{:04X}",
                output.state, output.zsw1.0
            );
        }
    }
}
