//! The few things that are needed of XML, names without their prefixes.

use quick_xml::events::{BytesStart, Event};

use super::Read;

/// What an element begins, ends or holds.
pub(super) enum Piece<'a> {
    Start(BytesStart<'a>),
    End(BytesStart<'a>),
    Text(String),
}

/// The pieces of a text.
pub(super) struct Pieces<'a> {
    reader: quick_xml::Reader<&'a [u8]>,
}

impl<'a> Pieces<'a> {
    pub fn of(text: &'a str) -> Self {
        let mut reader = quick_xml::Reader::from_str(text);
        reader.config_mut().expand_empty_elements = true;
        Self { reader }
    }

    /// The next one; `None` at the end.
    pub fn next(&mut self) -> Read<Option<Piece<'a>>> {
        loop {
            let event = self
                .reader
                .read_event()
                .map_err(|_| format!("its XML is damaged at byte {}", self.reader.error_position()))?;
            return Ok(Some(match event {
                Event::Start(element) | Event::Empty(element) => Piece::Start(element),
                Event::End(element) => {
                    let name = element.name().as_ref().to_string();
                    let length = name.len();
                    Piece::End(BytesStart::from_content(name, length))
                }
                Event::Text(text) => Piece::Text(text.xml10_content().into_owned()),
                Event::CData(text) => Piece::Text(text.xml10_content().into_owned()),
                Event::GeneralRef(name) => Piece::Text(match (name.resolve_char_ref(), &*name.xml10_content()) {
                    (Ok(Some(letter)), _) => letter.to_string(),
                    (_, "amp") => "&".into(),
                    (_, "lt") => "<".into(),
                    (_, "gt") => ">".into(),
                    (_, "quot") => "\"".into(),
                    (_, "apos") => "'".into(),
                    _ => String::new(),
                }),
                Event::Eof => return Ok(None),
                _ => continue,
            }));
        }
    }
}

/// The name of an element.
pub(super) fn name<'a>(element: &'a BytesStart<'_>) -> &'a str {
    element.local_name().into_inner()
}

/// The value of an attribute.
pub(super) fn attribute(element: &BytesStart<'_>, wanted: &str) -> Option<String> {
    let mut attributes = element.attributes();
    let found = attributes.with_checks(false).flatten().find(|found| found.key.local_name().as_ref() == wanted)?;
    found.normalized_value(quick_xml::XmlVersion::default()).ok().map(std::borrow::Cow::into_owned)
}
