//! Tables of a drive model: parameters, fault numbers and modules.
//!
//! The tables of a model are generated from its folder in `data/` (`cargo run -p xtask -- gen`); the code here only finds
//! things in them.
//!
//! ```
//! use profidrive_profile::catalogue::{AKD, Scaling};
//! let acceleration = AKD.by_name("drv.acc").unwrap();
//! assert_eq!(acceleration.pnu, 2108);
//! assert_eq!(acceleration.engineering(3_000_000, &Scaling::default()), 3000.0); // rpm/s
//! assert_eq!(AKD.by_pnu(2203).unwrap().choice(7), Some("To the zero angle of the feedback"));
//! assert_eq!(AKD.nearest("DRV.AC", 1)[0].name, "DRV.ACC");
//! ```

use alloc::vec::Vec;
use core::cmp::Ordering;

use crate::notation::Notation;

mod akd;
mod backup;
mod common;
mod device;
mod fault;
mod generated_names;
mod generated_parts;
mod generated_vendors;
mod nearest;
mod number;
mod parameter;
mod part;
mod tables;
mod vacon;
mod vendor;
mod vlt;
mod word;

pub use akd::AKD;
pub use backup::{BackupRule, Phase, Role};
pub use common::CommonName;
pub use device::{DescriptionFacts, Device, Layout, ParameterPoint, RecordView, TelegramModule, Words};
pub use fault::{Cleared, Fault, Reaction};
pub use generated_parts::Part;
pub use nearest::name_distance;
pub use parameter::{Access, Meaning, Parameter, Scale, Scaling, Size};
pub use part::{PartNumbers, PartRow};
pub use tables::{Tables, padded};
pub use vacon::VACON;
pub use vendor::vendor_name;
pub use vlt::VLT;
pub use word::{Field, Word, WordKind};

/// The tables of one drive model.
#[derive(Debug)]
pub struct Catalogue {
    /// Name of the model, for example `AKD`.
    pub model: &'static str,
    /// How the vendor writes the numbers of its parameters.
    pub notation: Notation,
    /// What scales values in a drive as delivered.
    pub scaling: Scaling,
    /// All parameters, ascending by PNU, elements of one PNU by subindex.
    pub parameters: &'static [Parameter],
    /// Fault and warning numbers with their meaning, ascending by number.
    pub faults: &'static [Fault],
    /// Identity, modules and telegrams on the field bus.
    pub device: Device,
    /// What each parameter that is not a plain setting is to a tool that saves and restores, ascending by PNU.
    pub backup: &'static [BackupRule],
    /// What parameters are to drive and client, in the order of the table.
    pub parts: &'static [PartRow],
    /// Parameters whose bits have a meaning each, ascending by PNU.
    pub words: &'static [Word],
    /// What to do when the present state forbids a write (error 0x11), for parameters where more can be said than that,
    /// ascending by PNU.
    pub not_now: &'static [(u16, &'static str)],
    /// Position in `parameters` plus one by PNU, 0 where there is none.
    index: &'static [u16],
    /// Positions in `parameters`, ordered by name without regard to case.
    names: &'static [u16],
}

impl Catalogue {
    /// Returns the parameter with this name, case does not matter. Where the vendor gave one name to several numbers,
    /// the first of the vendor's own range; [`all_by_name`](Self::all_by_name) has all. Three other ways to write a
    /// name are accepted too: without the `_32` of a value cut to 32 bits (`VL.FB`), with `PN.` before a signal
    /// (`PN.STW1`, AKD PROFINET manual 6.3 and 6.6), and a signal by the parameter that it sets (`MT.FEEDRATE`, 5.8).
    /// Where parameters are numbers to their vendor (VLT, Vacon), only letters and digits of a name count:
    /// `ramp-1-ramp-up-time` is `Ramp 1 Ramp up Time`.
    #[must_use]
    pub fn by_name(&self, name: &str) -> Option<&'static Parameter> {
        let exact = |name: &str| self.all_by_name(name).next();
        let signal = || match name.split_once('.') {
            Some((group, signal)) if group.eq_ignore_ascii_case("PN") => exact(signal),
            _ => None,
        };
        exact(name)
            .or_else(|| exact(&[name, "_32"].concat()))
            .or_else(signal)
            .or_else(|| exact(&name.replace('.', "_")))
            .or_else(|| self.by_letters(name))
    }

    /// Returns the first parameter with these letters and digits in its name, whatever stands between them.
    fn by_letters(&self, name: &str) -> Option<&'static Parameter> {
        let letters = |text: &str| -> Vec<u8> {
            let used = text.bytes().filter(u8::is_ascii_alphanumeric);
            used.map(|byte| byte.to_ascii_uppercase()).collect()
        };
        let wanted = letters(name);
        if self.notation == Notation::Name || wanted.is_empty() {
            return None;
        }
        self.parameters
            .iter()
            .find(|parameter| letters(parameter.name) == wanted)
    }

    /// Returns all parameters with this name, case does not matter.
    pub fn all_by_name(&self, name: &str) -> impl Iterator<Item = &'static Parameter> {
        let named = |position: &u16| {
            self.parameters
                .get(usize::from(*position))
                .map_or("", |found| found.name)
        };
        let start = self
            .names
            .partition_point(|position| compare(named(position), name) == Ordering::Less);
        let end = self
            .names
            .partition_point(|position| compare(named(position), name) != Ordering::Greater);
        let positions = self.names.get(start..end).unwrap_or_default();
        positions
            .iter()
            .filter_map(|position| self.parameters.get(usize::from(*position)))
    }

    /// Up to `count` parameters whose names are nearest to a name that does not exist, best first; none when nothing
    /// is near.
    #[must_use]
    pub fn nearest(&self, name: &str, count: usize) -> Vec<&'static Parameter> {
        nearest::nearest(self.parameters, name, count)
    }

    /// Parameters whose name, common name or description contains `text` (case does not matter), ascending by PNU.
    ///
    /// ```
    /// use profidrive_profile::catalogue::AKD;
    /// let found: Vec<_> = AKD.filter("ramp-up").map(|parameter| parameter.name).collect();
    /// assert!(found.contains(&"DRV.ACC"));
    /// ```
    pub fn filter<'a>(&'a self, text: &'a str) -> impl Iterator<Item = &'static Parameter> + use<'a> {
        self.parameters.iter().filter(move |parameter| {
            contains(parameter.name, text)
                || contains(parameter.description, text)
                || self
                    .common_names(parameter)
                    .any(|common| contains(common.name, text))
        })
    }

    /// Returns the remedy for a write that is refused because of the present state (error 0x11).
    ///
    /// ```
    /// use profidrive_profile::catalogue::AKD;
    /// assert!(AKD.not_now(915).unwrap().contains("PNU 922"));
    /// assert!(AKD.not_now(922).unwrap().contains("no controller"));
    /// assert!(AKD.not_now(5).unwrap().contains("only its telegram"));
    /// assert!(AKD.not_now(2108).is_none());
    /// ```
    #[must_use]
    pub fn not_now(&self, pnu: u16) -> Option<&'static str> {
        let found = self.not_now.binary_search_by_key(&pnu, |row| row.0);
        found.ok().and_then(|at| self.not_now.get(at)).map(|row| row.1)
    }

    /// Returns the bits of a parameter; `None` when it is not a word.
    #[must_use]
    pub fn word(&self, pnu: u16) -> Option<&'static Word> {
        self.word_at(pnu, None)
    }

    /// As [`word`](Self::word), for any parameter: `base` is [`Parameter::base`].
    #[must_use]
    pub fn word_at(&self, pnu: u16, base: Option<u16>) -> Option<&'static Word> {
        let found = self
            .words
            .binary_search_by_key(&(pnu, base), |word| (word.pnu, word.base));
        found.ok().and_then(|at| self.words.get(at))
    }

    /// Returns the kind of a parameter for a tool that saves and restores.
    ///
    /// ```
    /// use profidrive_profile::catalogue::{AKD, Phase, Role};
    /// assert_eq!(AKD.backup_rule(3014).phase, Phase::Scaling); // PN.POSSCALE
    /// assert_eq!(AKD.backup_rule(2242).role, Role::Action); // MOTOR.BRAKERLS
    /// assert_eq!(AKD.backup_rule(2108).role, Role::Setting); // DRV.ACC
    /// ```
    #[must_use]
    pub fn backup_rule(&self, pnu: u16) -> BackupRule {
        self.backup_rule_at(pnu, None)
    }

    /// As [`backup_rule`](Self::backup_rule), for any parameter: `base` is [`Parameter::base`].
    #[must_use]
    pub fn backup_rule_at(&self, pnu: u16, base: Option<u16>) -> BackupRule {
        let found = self
            .backup
            .binary_search_by_key(&(pnu, base), |rule| (rule.pnu, rule.base));
        found
            .ok()
            .and_then(|at| self.backup.get(at))
            .copied()
            .unwrap_or_else(|| BackupRule {
                base,
                ..BackupRule::plain(pnu)
            })
    }

    /// Returns whether the drive can keep the value of a parameter over a power cycle: another name for a setting is
    /// kept with that setting. Source: column `nv` of the tables, and their rows of aliases.
    #[must_use]
    pub fn is_kept(&self, parameter: &Parameter) -> bool {
        match self.backup_rule_at(parameter.pnu, parameter.base).role {
            Role::Alias { of } => self.by_pnu(of).is_some_and(|of| of.saved),
            _ => parameter.saved,
        }
    }

    /// Returns the first parameter with this role.
    #[must_use]
    pub fn with_role(&self, role: Role) -> Option<&'static Parameter> {
        let rule = self.backup.iter().find(|rule| rule.role == role)?;
        self.by_address(rule.pnu, rule.base)
    }

    /// Meaning of a fault number (`F702`) or, with `warning`, of a warning number (`n702`).
    #[must_use]
    pub fn fault(&self, number: u16, warning: bool) -> Option<&'static Fault> {
        let start = self.faults.partition_point(|fault| fault.number < number);
        let same = self
            .faults
            .get(start..)?
            .iter()
            .take_while(|fault| fault.number == number);
        same.into_iter().find(|fault| fault.warning == warning)
    }
}

/// Order of two names without regard to ASCII case.
fn compare(a: &str, b: &str) -> Ordering {
    a.bytes()
        .map(|byte| byte.to_ascii_uppercase())
        .cmp(b.bytes().map(|byte| byte.to_ascii_uppercase()))
}

/// Returns true when `text` contains `part` without regard to ASCII case.
fn contains(text: &str, part: &str) -> bool {
    let (text, part) = (text.as_bytes(), part.as_bytes());
    part.is_empty()
        || text
            .windows(part.len())
            .any(|window| window.eq_ignore_ascii_case(part))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_parameter_is_found_by_number_and_by_name() {
        assert_eq!(AKD.parameters.len(), 800);
        for parameter in AKD.parameters {
            assert_eq!(AKD.by_pnu(parameter.pnu).unwrap().pnu, parameter.pnu);
            let lower = parameter.name.to_ascii_lowercase();
            assert!(
                AKD.all_by_name(&lower).any(|found| found.pnu == parameter.pnu),
                "{}",
                parameter.name
            );
        }
        assert!(AKD.parameters.windows(2).all(|pair| pair[0].pnu < pair[1].pnu));
        assert!(AKD.by_pnu(0).is_none() && AKD.by_pnu(2005).is_none() && AKD.by_pnu(u16::MAX).is_none());
    }

    #[test]
    fn halves_of_wide_values_have_unique_numbers() {
        let wide = AKD.parameters.iter().filter(|parameter| parameter.wide);
        assert_eq!(wide.clone().count(), 121);
        for parameter in wide {
            let high = parameter.high().unwrap();
            assert!(AKD.by_pnu(high).is_none());
            assert_eq!(AKD.by_high(high).unwrap().pnu, parameter.pnu);
            assert_eq!(parameter.size, Size::Dword);
        }
        let numbers: Vec<u16> = AKD.numbers().collect();
        assert_eq!(numbers.len(), 921);
        assert!(numbers.windows(2).all(|pair| pair[0] < pair[1]));
        assert!(AKD.by_high(2108).is_none() && AKD.by_high(2136).is_none() && AKD.by_high(0).is_none());
    }

    #[test]
    fn double_names_keep_all_their_numbers() {
        let numbers = |name: &str| AKD.all_by_name(name).map(|found| found.pnu).collect::<Vec<_>>();
        assert_eq!(numbers("DRV.CLRFAULTS"), [2111, 2112]);
        assert_eq!(numbers("TEMP.POWER"), [2875, 2876, 2877]);
        assert_eq!(numbers("HOME.MODE"), [2203, 1001]);
        assert_eq!(AKD.by_name("home.mode").unwrap().pnu, 2203);
        assert_eq!(AKD.by_name("vl.fb").unwrap().pnu, 2428);
        assert_eq!(AKD.by_name("pn.stw1").unwrap().pnu, 1);
        assert!(AKD.by_name("PN.").is_none() && AKD.by_name("_32").is_none());
        assert_eq!(numbers("NO.SUCH"), []);
        assert_eq!(numbers(""), []);
    }

    #[test]
    fn numbers_the_project_relies_on() {
        let expected = [
            (2108, "DRV.ACC"),
            (2115, "DRV.DEC"),
            (2110, "DRV.ACTIVE"),
            (2118, "DRV.DIS"),
            (2127, "DRV.EN"),
            (2120, "DRV.DISSOURCES"),
            (2131, "DRV.ICONT"),
            (2132, "DRV.IPEAK"),
            (2134, "DRV.MOTIONSTAT"),
            (2135, "DRV.OPMODE"),
            (2136, "DRV.RSTVAR"),
            (2137, "DRV.STOP"),
            (2157, "FBUS.PARAM01"),
            (2158, "FBUS.PARAM02"),
            (2214, "IL.CMD"),
            (2216, "IL.FB"),
            (2294, "PL.FB"),
            (2403, "VBUS.VALUE"),
            (2425, "VL.CMD_32"),
            (2426, "VL.CMDU_32"),
            (2428, "VL.FB_32"),
            (2469, "DRV.NVSAVE"),
            (2477, "DRV.FAULT1"),
            (2486, "DRV.FAULT10"),
            (2788, "DRV.NVLOAD"),
            (3014, "PN.POSSCALE"),
            (3022, "PN.TIMEOUTFTHRESH"),
            (3064, "PN.VELSCALING"),
            (3065, "PN.ACCSCALING"),
        ];
        for (pnu, name) in expected {
            assert_eq!(AKD.by_pnu(pnu).unwrap().name, name);
        }
    }

    #[test]
    fn limits_and_defaults_agree_with_each_other_and_with_the_size() {
        let scaling = Scaling::default();
        for parameter in AKD.parameters {
            let (low, high) = parameter.raw_limits(&scaling);
            assert!(low <= high, "{parameter:?}");
            let default = parameter.raw_default(&scaling);
            assert!(
                (low..=high).contains(&default),
                "{} default {default} not in {low}..={high}",
                parameter.name
            );
            for choice in parameter.choices {
                assert!(
                    parameter.range().contains(&i64::from(choice.value)),
                    "{parameter:?}"
                );
            }
        }
    }

    #[test]
    fn filter_looks_into_names_and_descriptions() {
        let names: Vec<_> = AKD.filter("nvsave").map(|found| found.name).collect();
        assert_eq!(names, ["DRV.NVSAVE"]);
        assert!(AKD.filter("watchdog").any(|found| found.pnu == 3022));
        assert_eq!(AKD.filter("").count(), 800);
    }

    #[test]
    fn rules_of_saving_and_restoring_fit_the_table() {
        assert!(AKD.backup.windows(2).all(|pair| pair[0].pnu < pair[1].pnu));
        for rule in AKD.backup {
            let parameter = AKD.by_pnu(rule.pnu).unwrap();
            match rule.role {
                Role::Alias { of } => assert_eq!(AKD.backup_rule(of).role, Role::Setting),
                Role::Save | Role::ClearFaults => assert_eq!(parameter.access, Access::WriteOnly),
                Role::Active => assert_eq!(parameter.access, Access::ReadOnly),
                _ => assert_eq!(parameter.access, Access::ReadWrite, "{}", parameter.name),
            }
        }
        assert_eq!(AKD.with_role(Role::Save).unwrap().name, "DRV.NVSAVE");
        assert_eq!(AKD.with_role(Role::Active).unwrap().name, "DRV.ACTIVE");
        assert_eq!(AKD.backup_rule(2031).role, Role::Setting); // CAP0.MODE
        assert_eq!(AKD.backup_rule(2261).phase, Phase::Motor); // MOTOR.VMAX
        assert_eq!(AKD.backup_rule(2260).phase, Phase::Scaling); // MOTOR.TYPE: the first row counts
        assert_eq!(AKD.backup_rule(2110).role, Role::Active);
        assert_eq!(AKD.backup_rule(930).role, Role::Alias { of: 2135 });
        for (name, kept) in [("DRV.OPMODE", true), ("HOME.V", false), ("DRV.ACC", true)] {
            assert_eq!(AKD.is_kept(AKD.by_name(name).unwrap()), kept, "{name}");
        }
        for (pnu, kept) in [(930, true), (922, false)] {
            assert_eq!(AKD.is_kept(AKD.by_pnu(pnu).unwrap()), kept, "{pnu}");
        }
    }

    #[test]
    fn faults_and_warnings_are_distinct() {
        assert!(AKD.faults.windows(2).all(|pair| pair[0].number <= pair[1].number));
        assert!(
            AKD.fault(702, false)
                .unwrap()
                .meaning
                .to_ascii_lowercase()
                .contains("fieldbus")
        );
        assert!(AKD.fault(107, false).is_none() && AKD.fault(107, true).is_some());
    }

    #[test]
    fn every_fault_has_a_reaction_and_a_remedy() {
        for fault in AKD.faults {
            assert_eq!(fault.warning, fault.reaction == Reaction::None, "{fault:?}");
            assert_eq!(fault.warning, fault.cleared == Cleared::ByItself, "{fault:?}");
            // manual 8.1 has a list of solutions for 702
            let most = if fault.number == 702 { 400 } else { 110 };
            assert!((8..most).contains(&fault.remedy.len()), "{fault:?}");
            assert_eq!(AKD.fault(fault.number, fault.warning), Some(fault), "{fault:?}");
        }
        let reaction = |number| AKD.fault(number, false).unwrap().reaction;
        assert_eq!(reaction(405), Reaction::DynamicBrake); // as the fault card says
        assert_eq!(reaction(419), Reaction::Coast);
        assert_eq!(reaction(702), Reaction::QuickStop);
        assert!(AKD.fault(439, false).unwrap().recalled && !AKD.fault(438, true).unwrap().recalled);
    }

    #[test]
    fn telegrams_of_the_device() {
        let telegrams: Vec<_> = AKD
            .device
            .telegrams
            .iter()
            .map(|module| module.telegram)
            .collect();
        assert_eq!(telegrams, [1, 7, 9, 350, 351, 352, 353, 354, 400, 0]);
        assert_eq!(AKD.device.telegram(1).unwrap().inputs, 4);
        assert!(AKD.device.telegram(2).is_none());
        let by_ident = AKD
            .device
            .telegram_of_module(AKD.device.telegram(353).unwrap().module)
            .unwrap();
        assert_eq!(by_ident.telegram, 353);
    }
}
