use alloc::string::{String, ToString as _};
use alloc::vec::Vec;

use super::*;
use crate::fixtures::{NAME, description};

fn sound() -> String {
    description().to_xml()
}

/// Returns the problems of a file changed at one place.
fn after(from: &str, to: &str) -> Vec<(Severity, Rule, String)> {
    let text = sound();
    assert!(text.contains(from), "{from} is not in the file");
    let report = check(text.replacen(from, to, 1).as_bytes(), Some(NAME));
    let found = report.problems.into_iter();
    found
        .map(|problem| (problem.severity, problem.rule, problem.message))
        .collect()
}

#[test]
fn a_sound_file_has_no_problem() {
    let report = check(sound().as_bytes(), Some(NAME));
    assert_eq!(report.problems, []);
    assert!(report.is_sound());
    assert_eq!(report.description, Some(description()));
}

/// Numbers of modes and measurements are not identifiers of objects: they may be equal to each other and to an
/// object's.
#[test]
fn numbers_of_profienergy_are_no_identifiers() {
    let energy = "<PROFIenergy><EnergySavingModeList><EnergySavingModeItem ID=\"1\"/><EnergySavingModeItem ID=\"2\"/>\
        </EnergySavingModeList><MeasurementList><MeasurementItem ID=\"1\"><MeasurementValue ID=\"1\"/>\
        <MeasurementValue ID=\"M_1\"/></MeasurementItem><MeasurementItem ID=\"2\"><MeasurementValue ID=\"1\"/>\
        </MeasurementItem></MeasurementList></PROFIenergy></VirtualSubmoduleItem>";
    assert_eq!(after("</VirtualSubmoduleItem>", energy), []);
}

/// Nothing refers to a virtual submodule: a second one with its identifier is an error, but the file can be used.
#[test]
fn an_identifier_that_nothing_refers_to_leaves_the_file_usable() {
    let text = sound();
    let ids: Vec<&str> = text.split("<VirtualSubmoduleItem ID=\"").skip(1).collect();
    let id = |at: usize| ids.get(at).and_then(|rest| rest.split('"').next()).unwrap();
    let problems = after(
        &alloc::format!("ID=\"{}\"", id(1)),
        &alloc::format!("ID=\"{}\"", id(0)),
    );
    let expected = alloc::format!("identifier `{}` is that of a VirtualSubmoduleItem too", id(0));
    assert_eq!(problems, [(Severity::Error, Rule::Identifier, expected)]);
}

/// Each rule by a file that breaks it at one place and no other rule.
#[test]
fn every_rule_is_looked_at() {
    use Rule as R;
    use Severity::{Error, Unusable, Warning};
    let broken = [
        (
            " DeviceID=\"0x0001\"",
            "",
            Unusable,
            R::Attribute,
            "DeviceIdentity has no attribute DeviceID",
        ),
        (
            "DeviceID=\"0x0001\"",
            "deviceid=\"1\"",
            Unusable,
            R::Attribute,
            "no attribute DeviceID",
        ),
        (
            "<VendorName Value=\"Vendor\"/>",
            "",
            Error,
            R::Element,
            "DeviceIdentity has no VendorName",
        ),
        (
            "MainFamily=\"Drives\"",
            "MainFamily=\"Drive\"",
            Error,
            R::Value,
            "MainFamily `Drive`",
        ),
        (
            "<ProfileRevision>1.00",
            "<ProfileRevision>1.01",
            Error,
            R::Value,
            "must be `1.00`",
        ),
        (
            "-V2.35.xsd",
            "-V2.4.xsd",
            Error,
            R::FileName,
            "says schema V2.35, the file V2.4",
        ),
        (
            "PNIO_Version=\"V2.35\"",
            "PNIO_Version=\"V2.4\"",
            Error,
            R::Version,
            "newer than the schema",
        ),
        (
            "PNIO_Version=\"V2.35\"",
            "PNIO_Version=\"2.35\"",
            Error,
            R::Value,
            "expected a version",
        ),
        (
            "LLDP_NoD_Supported=\"true\"",
            "LLDP_NoD_Supported=\"false\"",
            Error,
            R::Version,
            "LLDP_NoD",
        ),
        (
            "ResetToFactoryModes=\"2\"",
            "ResetToFactoryModes=\"1\"",
            Error,
            R::Version,
            "mode 2",
        ),
        (
            "MinDeviceInterval=\"512\"",
            "MinDeviceInterval=\"0\"",
            Error,
            R::Value,
            "MinDeviceInterval is 0",
        ),
        (
            "MinDeviceInterval=\"512\"",
            "MinDeviceInterval=\"65536\"",
            Unusable,
            R::Value,
            "from 0 to 65535",
        ),
        (
            "MinDeviceInterval=\"512\"",
            "MinDeviceInterval=\"60000\"",
            Error,
            R::Value,
            "no send clock",
        ),
        (
            "DNS_CompatibleName=\"drive\"",
            "DNS_CompatibleName=\"My_Drive\"",
            Error,
            R::Value,
            "not a valid station name",
        ),
        (
            "MaxSupportedRecordSize=\"65535\"",
            "MaxSupportedRecordSize=\"1024\"",
            Error,
            R::Value,
            "below 4068",
        ),
        (
            "AddressAssignment=\"DCP\"",
            "AddressAssignment=\"DHCP\"",
            Error,
            R::Value,
            "no DCP",
        ),
        (
            "MaxInputLength=\"9\"",
            "MaxInputLength=\"8\"",
            Error,
            R::Length,
            "needs 9 octets of input",
        ),
        (
            "MaxInputLength=\"9\"",
            "MaxInputLength=\"1441\"",
            Error,
            R::Length,
            "at most 1440",
        ),
        (
            "AllowedInSlots=\"1\"",
            "AllowedInSlots=\"1..2\"",
            Error,
            R::Value,
            "not within PhysicalSlots",
        ),
        (" AllowedInSlots=\"1\"", "", Error, R::Value, "fits nowhere"),
        (
            "ModuleItemTarget=\"M_1\"",
            "ModuleItemTarget=\"M_9\"",
            Unusable,
            R::Reference,
            "no module `M_9`",
        ),
        (
            "ID=\"M_2\"",
            "ID=\"M_1\"",
            Unusable,
            R::Identifier,
            "module `M_1` is there twice",
        ),
        (
            "ID=\"S_1\"",
            "ID=\"M_1\"",
            Error,
            R::Identifier,
            "is that of a ModuleItem too",
        ),
        (
            "Name TextId=\"T_M1\"",
            "Name TextId=\"T_NONE\"",
            Error,
            R::Text,
            "there is no text `T_NONE`",
        ),
        (
            "Text TextId=\"T_M1\"",
            "Text TextId=\"T_M2\"",
            Unusable,
            R::Identifier,
            "text `T_M2` is there twice",
        ),
        (
            "ModuleIdentNumber=\"0x00000011\"",
            "ModuleIdentNumber=\"0\"",
            Error,
            R::Value,
            "no module",
        ),
        (
            "SupportedRT_Classes=\"RT_CLASS_1\"",
            "SupportedRT_Classes=\"RT_CLASS_2\"",
            Error,
            R::Value,
            "RT_CLASS_1",
        ),
        (
            "StartupMode=\"Legacy;Advanced\"",
            "StartupMode=\"Advanced\"",
            Warning,
            R::Value,
            "without Legacy",
        ),
        (
            "SendClock=\"32\"",
            "SendClock=\"64\"",
            Error,
            R::Value,
            "no 32 (1 ms)",
        ),
        (
            "SubslotNumber=\"32769\"",
            "SubslotNumber=\"2\"",
            Error,
            R::Value,
            "none of a port",
        ),
        (
            "Consistency=\"All items consistency\"",
            "Consistency=\"Some\"",
            Error,
            R::Value,
            "is not known",
        ),
        (
            "DataType=\"Unsigned16\"",
            "DataType=\"Word\"",
            Unusable,
            R::Length,
            "has no length",
        ),
        (
            "Index=\"100\"",
            "Index=\"40000\"",
            Error,
            R::Value,
            "end at 32767",
        ),
        (
            "ParameterRecordDataItem Index=\"100\" Length=\"4\"",
            "ParameterRecordDataItem Index=\"100\" Length=\"3\"",
            Error,
            R::Length,
            "constants end at octet 4",
        ),
        (
            "Data=\"0x00,0x01,0x02,0x03\"",
            "Data=\"0x00,1,2,3\"",
            Unusable,
            R::Value,
            "not an octet such as 0x1F",
        ),
        (
            "MenuTarget=\"MENU_B\"",
            "MenuTarget=\"MENU_A\"",
            Unusable,
            R::Loop,
            "in a circle",
        ),
        (
            "ValueItemTarget=\"V_1\"",
            "ValueItemTarget=\"V_9\"",
            Error,
            R::Reference,
            "no value item `V_9`",
        ),
        (
            "GraphicItemTarget=\"G_1\"",
            "GraphicItemTarget=\"G_9\"",
            Error,
            R::Reference,
            "no graphic `G_9`",
        ),
        (
            "GraphicFile=\"GSDML-0105-0001-X\"",
            "GraphicFile=\"../X\"",
            Warning,
            R::FileName,
            "does not begin with",
        ),
        (
            "FixedInSubslots=\"2\"",
            "FixedInSubslots=\"1\"",
            Error,
            R::Value,
            "where another one is",
        ),
        (
            "Writeable_IM_Records=\"1..4\"",
            "Writeable_IM_Records=\"0..4\"",
            Error,
            R::Value,
            "I&M1",
        ),
        ("xml:lang=\"de\"", "lang=\"de\"", Error, R::Attribute, "xml:lang"),
        (
            "<Text TextId=\"T_M1\" Value=\"Telegramm 1\"/>",
            "<Text TextId=\"T_X\" Value=\"\"/>",
            Error,
            R::Text,
            "not in the primary language",
        ),
        (
            "<IOData",
            "<IoData/><IOData",
            Error,
            R::Element,
            "it is written IOData",
        ),
        (
            "<Graphics>",
            "<Later/><Graphics>",
            Warning,
            R::Element,
            "Later in DeviceAccessPointItem is not known",
        ),
        (
            "<DeviceFunction>",
            "words<DeviceFunction>",
            Error,
            R::Element,
            "text in ProfileBody",
        ),
    ];
    for (from, to, severity, rule, words) in broken {
        let found = after(from, to);
        assert!(
            found
                .iter()
                .any(|problem| problem.0 == severity && problem.1 == rule && problem.2.contains(words)),
            "{from} -> {to}: {found:?}"
        );
    }
}

#[test]
fn order_errors_name_both_elements() {
    let text = sound();
    let (start, end) = (
        text.find("<VirtualSubmoduleList>").unwrap(),
        text.find("<Graphics>").unwrap(),
    );
    let graphics_end = text.find("</Graphics>").unwrap() + "</Graphics>".len();
    let moved = [
        &text[..start],
        &text[end..graphics_end],
        &text[start..end],
        &text[graphics_end..],
    ]
    .concat();
    let report = check(moved.as_bytes(), None);
    let order: Vec<_> = report
        .problems
        .iter()
        .filter(|problem| problem.rule == Rule::Order)
        .collect();
    assert_eq!(order.len(), 2, "{:?}", report.problems);
    assert!(
        order[0]
            .message
            .contains("VirtualSubmoduleList stands behind Graphics"),
        "{}",
        order[0]
    );
    // the meaning does not hang on the order
    assert_eq!(report.description, Some(description()));
}

#[test]
fn all_problems_at_once_in_the_order_of_the_file() {
    let text = sound()
        .replace("MinDeviceInterval=\"512\"", "MinDeviceInterval=\"0\"")
        .replace("MainFamily=\"Drives\"", "MainFamily=\"D\"")
        .replace("StartupMode=\"Legacy;Advanced\"", "StartupMode=\"Advanced\"");
    let report = check(text.as_bytes(), Some("drive.xml"));
    let rules: Vec<_> = report.problems.iter().map(|problem| problem.rule).collect();
    assert_eq!(rules, [Rule::FileName, Rule::Value, Rule::Value, Rule::Value]);
    assert!(
        report
            .problems
            .windows(2)
            .all(|pair| pair[0].position <= pair[1].position)
    );
    assert!(!report.is_sound() && report.description.is_some());
}

#[test]
fn the_report_is_bounded_and_never_hides_what_forbids_the_use() {
    let many = "<Text TextId=\"T_X\" Value=\"\"/>".repeat(400);
    let text = sound().replace("</PrimaryLanguage>", &(many + "</PrimaryLanguage>"));
    let report = check(text.as_bytes(), None);
    assert!(report.problems.len() <= 201 && report.left_out > 150);
    assert!(report.description.is_none() && !report.is_sound());
    let noise = "<Later/>".repeat(400);
    let text = sound()
        .replace("<ModuleList>", &(noise + "<ModuleList>"))
        .replace("<Text TextId=\"T_M2\"", "<Text TextId=\"T_M1\"");
    let report = check(text.as_bytes(), None);
    assert!(report.description.is_none(), "{:?}", report.problems.last());
}

#[test]
fn a_file_that_is_not_gsdml_is_rejected() {
    for (text, rule) in [
        ("", Rule::Xml),
        ("<a/>", Rule::Root),
        ("<a>", Rule::Xml),
        ("\0", Rule::Xml),
        ("<a b='1' b='2'/>", Rule::Xml),
        ("<a>&b;</a>", Rule::Entity),
        ("<ISO15745Profile/>", Rule::Element),
    ] {
        let report = check(text.as_bytes(), None);
        assert!(report.description.is_none());
        let first = &report
            .problems
            .iter()
            .find(|problem| problem.severity == Severity::Unusable);
        assert_eq!(
            first.map(|problem| problem.rule),
            Some(rule),
            "{text}: {:?}",
            report.problems
        );
        assert_eq!(crate::parse(text.as_bytes()).unwrap_err().rule, rule, "{text}");
        assert!(!report.problems[0].to_string().is_empty());
    }
}

/// Everything that could take the square of the file's size, at a size where that is measurable.
#[test]
fn large_files_take_time_in_proportion() {
    let many = 40_000;
    let text = sound();
    let lists = "0..70000 ".repeat(2000);
    let references: String = (0..many)
        .map(|n| alloc::format!("<ModuleItemRef ModuleItemTarget=\"X{n}\" AllowedInSlots=\"1\"/>"))
        .collect();
    let modules: String = (0..many)
        .map(|n| alloc::format!("<ModuleItem ID=\"X{n}\" ModuleIdentNumber=\"{n}\"/>"))
        .collect();
    let ports: String = (0..many)
        .map(|n| {
            alloc::format!(
                "<PortSubmoduleItem ID=\"Q{n}\" SubmoduleIdentNumber=\"3\" SubslotNumber=\"40000\"/>"
            )
        })
        .collect();
    let wide: String = (0..200)
        .map(|n| {
            alloc::format!(
                "<ModuleItem ID=\"W{n}\" ModuleIdentNumber=\"1\"><VirtualSubmoduleList><VirtualSubmoduleItem ID=\"WS{n}\" \
                 SubmoduleIdentNumber=\"1\" FixedInSubslots=\"0..4294967295\"/></VirtualSubmoduleList></ModuleItem>"
            )
        })
        .collect();
    let text = text
        .replace("</UseableModules>", &(references + "</UseableModules>"))
        .replace("</ModuleList>", &(modules + &wide + "</ModuleList>"))
        .replace(
            "</SystemDefinedSubmoduleList>",
            &(ports + "</SystemDefinedSubmoduleList>"),
        )
        .replace(
            "PhysicalSlots=\"0..1\"",
            &alloc::format!("PhysicalSlots=\"{lists}\""),
        );
    let report = check(text.as_bytes(), Some(NAME));
    assert_eq!(
        report.description.map(|read| read.modules.len()),
        Some(2 + many + 200)
    );
    assert!(report.left_out > many);
}

#[test]
fn elements_are_bounded() {
    let many = "<b/>".repeat(1_000_001);
    let report = check(alloc::format!("<a>{many}</a>").as_bytes(), None);
    assert!(report.description.is_none());
    assert!(report.problems.iter().any(|problem| problem.rule == Rule::Limit));
}
