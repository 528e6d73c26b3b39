//! Texts for people, each under its identifier, in one or more languages.

use alloc::collections::BTreeMap;
use alloc::string::String;
use core::fmt;

/// Identifier of a text.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct TextId(pub String);

impl From<&str> for TextId {
    fn from(id: &str) -> Self {
        Self(id.into())
    }
}

impl From<String> for TextId {
    fn from(id: String) -> Self {
        Self(id)
    }
}

impl fmt::Display for TextId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// The texts of one language.
pub type Language = BTreeMap<TextId, String>;

/// `ExternalTextList`: every text in the primary language (English), some also in others.
///
/// ```
/// use profidrive_gsdml::Texts;
/// let mut texts = Texts::default();
/// let id = texts.add("T_NAME", "Telegram 1");
/// texts.translate("de", &id, "Telegramm 1");
/// assert_eq!(texts.get(&id), Some("Telegram 1"));
/// assert_eq!(texts.in_language("de", &id), Some("Telegramm 1"));
/// assert_eq!(texts.in_language("fr", &id), Some("Telegram 1"));
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Texts {
    /// `PrimaryLanguage`.
    pub primary: Language,
    /// `Language` by its `xml:lang`, for example `de`.
    pub languages: BTreeMap<String, Language>,
}

impl Texts {
    /// Returns the text in the primary language.
    #[must_use]
    pub fn get(&self, id: &TextId) -> Option<&str> {
        self.primary.get(id).map(String::as_str)
    }

    /// Returns the text in a language, in the primary one where it is not translated.
    #[must_use]
    pub fn in_language(&self, language: &str, id: &TextId) -> Option<&str> {
        self.languages
            .get(language)
            .and_then(|texts| texts.get(id))
            .map(String::as_str)
            .or_else(|| self.get(id))
    }

    /// Adds a text in the primary language and gives its identifier back.
    pub fn add(&mut self, id: impl Into<TextId>, text: impl Into<String>) -> TextId {
        let id = id.into();
        self.primary.insert(id.clone(), text.into());
        id
    }

    /// Adds a translation.
    pub fn translate(&mut self, language: &str, id: &TextId, text: impl Into<String>) {
        self.languages
            .entry(language.into())
            .or_default()
            .insert(id.clone(), text.into());
    }
}
