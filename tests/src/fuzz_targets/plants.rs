//! Plant files and expectations, which are written by hand.

use plant::PlantPlan;

/// Two drives of different models.
const TWO: &str = "[[drive]]\nname = \"press-1\"\n[[drive]]\nname = \"feeder-1\"\nmodel = \"vlt\"\n";

/// A plant file or a text of expectations: a mistake is reported with a line of the text; expectations that are read print as
/// text that reads the same.
pub fn plant(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else {
        return;
    };
    let lines = text.split('\n').count();
    if let Err(error) = text.parse::<PlantPlan>() {
        assert!((1..=lines).contains(&error.line), "{error} of {lines} lines");
    }
    let two: PlantPlan = match TWO.parse() {
        Ok(two) => two,
        Err(error) => panic!("{error}"),
    };
    match two.expectations_of(text) {
        Ok(found) => {
            for expectation in found {
                let again = two.expectations_of(&expectation.to_string());
                let again = again.unwrap_or_else(|error| panic!("{error}: {expectation}"));
                assert!(again.len() == 1, "{expectation}");
                assert_eq!(again[0].to_string(), expectation.to_string());
            }
        }
        // one line more: the text may be a table that is put into a list
        Err(error) => assert!((1..=lines + 1).contains(&error.line), "{error} of {lines} lines"),
    }
}
