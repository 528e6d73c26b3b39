//! Classic BPF programs that select the received frames in the kernel.

use libc::{BPF_ABS, BPF_B, BPF_H, BPF_JEQ, BPF_JMP, BPF_JSET, BPF_K, BPF_LD, BPF_RET, BPF_W};
use profinet::MacAddress;
use socket2::SockFilter;

/// With more addresses than this the program only looks at EtherTypes; jumps reach 255 instructions.
pub(super) const MAX_ADDRESSES: usize = 100;

/// Frames that a socket receives.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Wanted {
    /// PROFINET frames only: the kernel does ARP and IP.
    Profinet,
    /// PROFINET, LLDP, ARP, and of IPv4 only UDP, TCP and ICMP: whole stations.
    Stations,
}

/// Where a jump goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum To {
    Next,
    Accept,
    Drop,
    /// To the instruction after [`Step::Here`] of this label.
    Label(u8),
}

#[derive(Debug, Clone, Copy)]
enum Step {
    /// Load one, two or four octets at an offset.
    Load(u32, u32),
    Equal(u32, To, To),
    AnyBit(u32, To, To),
    Here(u8),
}

/// Makes the program for stations with these addresses.
pub(super) fn program(wanted: Wanted, macs: &[MacAddress]) -> Vec<SockFilter> {
    assemble(&steps(wanted, macs))
        .into_iter()
        .map(|(code, jt, jf, k)| SockFilter::new(code, jt, jf, k))
        .collect()
}

fn steps(wanted: Wanted, macs: &[MacAddress]) -> Vec<Step> {
    use Step::{AnyBit, Equal, Here, Load};
    const UNTAGGED: u8 = 0;
    const ADDRESS: u8 = 1;
    let (to_address, stations) = (To::Label(ADDRESS), wanted == Wanted::Stations);
    let mut steps = vec![
        Load(BPF_H, 12),
        Equal(0x8100, To::Next, To::Label(UNTAGGED)),
        Load(BPF_H, 16),
    ];
    if stations {
        steps.extend([
            Equal(0x0806, to_address, To::Next),
            Equal(0x0800, to_address, To::Next),
            Equal(0x88CC, to_address, To::Next),
        ]);
    }
    steps.extend([
        Equal(0x8892, to_address, To::Drop),
        Here(UNTAGGED),
        Equal(0x8892, to_address, To::Next),
    ]);
    if stations {
        steps.extend([
            Equal(0x0806, to_address, To::Next),
            Equal(0x88CC, to_address, To::Next),
            Equal(0x0800, To::Next, To::Drop),
            Load(BPF_B, 23),
            Equal(17, to_address, To::Next),
            Equal(6, to_address, To::Next),
            Equal(1, to_address, To::Drop),
        ]);
    } else {
        steps.push(Equal(0, To::Drop, To::Drop));
    }
    steps.push(Here(ADDRESS));
    if macs.len() <= MAX_ADDRESSES {
        steps.extend([Load(BPF_B, 0), AnyBit(1, To::Accept, To::Next), Load(BPF_W, 2)]);
        steps.extend(macs.iter().map(|mac| {
            let [_, _, a, b, c, d] = mac.0;
            Equal(u32::from_be_bytes([a, b, c, d]), To::Accept, To::Next)
        }));
        steps.push(Equal(0, To::Drop, To::Drop));
    }
    steps
}

type Instruction = (u16, u8, u8, u32);

fn assemble(steps: &[Step]) -> Vec<Instruction> {
    let length = steps.iter().filter(|step| !matches!(step, Step::Here(_))).count();
    // Falling off the end accepts; the last two instructions are accept and drop.
    let target = |to: To, at: usize| -> u8 {
        let goal = match to {
            To::Next => at + 1,
            To::Accept => length,
            To::Drop => length + 1,
            To::Label(label) => steps
                .iter()
                .take_while(|step| !matches!(step, Step::Here(here) if *here == label))
                .filter(|step| !matches!(step, Step::Here(_)))
                .count(),
        };
        (goal - at - 1) as u8
    };
    let mut program = Vec::with_capacity(length + 2);
    for step in steps {
        let at = program.len();
        match *step {
            Step::Load(size, offset) => program.push(((BPF_LD | size | BPF_ABS) as u16, 0, 0, offset)),
            Step::Equal(value, yes, no) => {
                program.push((
                    (BPF_JMP | BPF_JEQ | BPF_K) as u16,
                    target(yes, at),
                    target(no, at),
                    value,
                ));
            }
            Step::AnyBit(bits, yes, no) => {
                program.push((
                    (BPF_JMP | BPF_JSET | BPF_K) as u16,
                    target(yes, at),
                    target(no, at),
                    bits,
                ));
            }
            Step::Here(_) => {}
        }
    }
    let ret = (BPF_RET | BPF_K) as u16;
    program.extend([(ret, 0, 0, u32::MAX), (ret, 0, 0, 0)]);
    program
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runs a program as the kernel does: a load beyond the end drops the frame.
    fn run(program: &[Instruction], frame: &[u8]) -> bool {
        let (mut at, mut a) = (0usize, 0u32);
        loop {
            let (code, jt, jf, k) = program[at];
            let code = u32::from(code);
            at += 1;
            if code == BPF_RET | BPF_K {
                return k != 0;
            } else if code & 7 == BPF_LD {
                let size = match code & 0x18 {
                    BPF_B => 1,
                    BPF_H => 2,
                    _ => 4,
                };
                let Some(bytes) = frame.get(k as usize..k as usize + size) else {
                    return false;
                };
                a = bytes.iter().fold(0, |n, b| n << 8 | u32::from(*b));
            } else {
                let yes = if code == BPF_JMP | BPF_JEQ | BPF_K {
                    a == k
                } else {
                    a & k != 0
                };
                at += usize::from(if yes { jt } else { jf });
            }
        }
    }

    fn frame(to: [u8; 6], rest: &[u8]) -> Vec<u8> {
        let mut frame = [&to[..], &[2, 9, 9, 9, 9, 9], rest].concat();
        frame.resize(60, 0);
        frame
    }

    #[test]
    fn lets_through_what_is_wanted_and_no_more() {
        let ours: Vec<_> = (1..=64).map(|n| MacAddress([2, 0, 0, 0, 0, n])).collect();
        let (mine, other, all) = ([2, 0, 0, 0, 0, 64], [2, 0, 0, 0, 1, 64], [0xFF; 6]);
        let udp = [&[0x08, 0x00, 0x45][..], &[0; 8], &[17]].concat();
        let icmp = [&[0x08, 0x00, 0x45][..], &[0; 8], &[1]].concat();
        let tcp = [&[0x08, 0x00, 0x45][..], &[0; 8], &[6]].concat();
        let cases: [(&str, Vec<u8>, bool, bool); 13] = [
            ("cyclic", frame(mine, &[0x88, 0x92]), true, true),
            (
                "cyclic, tagged",
                frame(mine, &[0x81, 0, 0xC0, 0, 0x88, 0x92]),
                true,
                true,
            ),
            (
                "DCP multicast",
                frame([1, 0x0E, 0xCF, 0, 0, 0], &[0x88, 0x92]),
                true,
                true,
            ),
            ("cyclic, other's", frame(other, &[0x88, 0x92]), false, false),
            ("ARP", frame(all, &[0x08, 0x06]), true, false),
            (
                "ARP, tagged",
                frame(all, &[0x81, 0, 0, 0, 0x08, 0x06]),
                true,
                false,
            ),
            ("UDP", frame(mine, &udp), true, false),
            ("ping", frame(mine, &icmp), true, false),
            ("TCP", frame(mine, &tcp), true, false),
            ("UDP, other's", frame(other, &udp), false, false),
            (
                "LLDP",
                frame([1, 0x80, 0xC2, 0, 0, 0x0E], &[0x88, 0xCC]),
                true,
                false,
            ),
            ("IPv6", frame(all, &[0x86, 0xDD]), false, false),
            ("stump", vec![2; 13], false, false),
        ];
        let stations = assemble(&steps(Wanted::Stations, &ours));
        let profinet = assemble(&steps(Wanted::Profinet, &ours));
        for (what, frame, for_stations, for_client) in cases {
            assert_eq!(run(&stations, &frame), for_stations, "{what}, stations");
            assert_eq!(run(&profinet, &frame), for_client, "{what}, client");
        }
    }

    #[test]
    fn very_many_addresses_are_left_to_the_runner() {
        for count in [0, 1, MAX_ADDRESSES, MAX_ADDRESSES + 1, 5000] {
            let macs = vec![MacAddress([2, 0, 0, 0, 0, 1]); count];
            let program = assemble(&steps(Wanted::Stations, &macs));
            assert!(program.len() <= 131);
            let strange = frame([2, 7, 7, 7, 7, 7], &[0x88, 0x92]);
            assert_eq!(run(&program, &strange), count > MAX_ADDRESSES);
        }
    }
}
