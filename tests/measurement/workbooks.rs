//! Workbooks: sound ones, damaged ones, and those that were made to take all memory.

use std::io::Write as _;

use flate2::write::DeflateEncoder;
use flate2::{Compression, Crc};

use super::read;

const SHEET: &[u8] = include_bytes!("../data/two-sheets.xlsx");
const HEADER: [&str; 6] =
    ["speed [mm/s]", "load_n", "drive_um", "frequency_hz", "amplitude_urad", "amplitude_sd_percent"];

/// An archive of these parts.
fn archive(parts: &[(&str, &[u8])]) -> Vec<u8> {
    let (mut bytes, mut directory) = (Vec::new(), Vec::new());
    for (name, content) in parts {
        let mut packed = DeflateEncoder::new(Vec::new(), Compression::fast());
        packed.write_all(content).expect("memory");
        let packed = packed.finish().expect("memory");
        let mut check = Crc::new();
        check.update(content);
        let sizes = [check.sum(), packed.len() as u32, content.len() as u32].map(u32::to_le_bytes).concat();
        let start = (bytes.len() as u32).to_le_bytes();
        let length = (name.len() as u16).to_le_bytes();
        let common = [&[20, 0, 0, 0, 8, 0, 0, 0, 0, 0][..], &sizes, &length, &[0, 0]].concat();
        bytes.extend([&b"PK\x03\x04"[..], &common, name.as_bytes(), &packed].concat());
        directory.extend([&b"PK\x01\x02\x14\0"[..], &common, &[0; 10], &start, name.as_bytes()].concat());
    }
    let at = (bytes.len() as u32).to_le_bytes();
    let (count, size) = ((parts.len() as u16).to_le_bytes(), (directory.len() as u32).to_le_bytes());
    bytes.extend([&directory[..], b"PK\x05\x06\0\0\0\0", &count, &count, &size, &at, &[0, 0]].concat());
    bytes
}

const RELATIONS: &str = r#"<Relationships><Relationship Id="r1" Type="x/worksheet" Target="worksheets/sheet1.xml"/>
<Relationship Id="r2" Type="x/sharedStrings" Target="/xl/shared.xml"/></Relationships>"#;

/// A workbook of Excel whose sheet holds these rows, with shared texts.
fn excel(rows: &str, shared: &str) -> Vec<u8> {
    let sheet = format!("<worksheet><sheetData>{rows}</sheetData></worksheet>");
    archive(&[
        ("xl/workbook.xml", br#"<workbook><sheets><sheet name="A &amp; B" r:id="r1"/></sheets></workbook>"#),
        ("xl/_rels/workbook.xml.rels", RELATIONS.as_bytes()),
        ("xl/shared.xml", format!("<sst>{shared}</sst>").as_bytes()),
        ("xl/worksheets/sheet1.xml", sheet.as_bytes()),
    ])
}

/// A workbook of LibreOffice whose second sheet holds these rows.
fn libre(rows: &str) -> Vec<u8> {
    let content = format!(
        "<office:document-content><office:spreadsheet><table:table table:name='empty'/>\
         <table:table table:name='T'>{rows}</table:table></office:spreadsheet></office:document-content>"
    );
    archive(&[("mimetype", b"application/vnd.oasis.opendocument.spreadsheet"), ("content.xml", content.as_bytes())])
}

fn shared_header() -> String {
    let cell = |(at, _): (usize, &&str)| format!("<c t='s'><v>{at}</v></c>");
    format!("<row>{}</row>", HEADER.iter().enumerate().map(cell).collect::<String>())
}

#[test]
fn texts_are_shared_rich_and_numbers_of_any_form() {
    let shared: String = HEADER[1..].iter().map(|name| format!("<si><t>{name}</t></si>")).collect();
    let shared = format!("<si><r><t>speed </t></r><r><t>[mm&#47;s]</t></r><rPh><t>no</t></rPh></si>{shared}");
    let row = |n: usize, f: f64| {
        format!(
            "<row r='{n}'><c r='A{n}'><v>20</v></c><c><v>2E1</v></c><c><f>1+1.5</f><v>2.5</v></c><c><v>{f}</v></c><c><v>1.5</v></c><c t='n'><v>1</v></c></row>"
        )
    };
    let rows = shared_header() + &row(2, 60.0) + &row(9, 61.0);
    let table = read("t.xlsx", &excel(&rows, &shared), "sheet = 'A & B'").unwrap_or_else(|error| panic!("{error}"));
    let seen: Vec<_> = table.points.iter().map(|p| (p.line, p.frequency, p.drive, p.load)).collect();
    assert_eq!(seen, [(2, 60.0, 2.5e-6, 20.0), (9, 61.0, 2.5e-6, 20.0)]);
}

#[test]
fn an_open_document_says_equal_cells_and_rows_once() {
    let text =
        |name: &str| format!("<table:table-cell office:value-type='string'><text:p>{name}</text:p></table:table-cell>");
    let header: String = HEADER.iter().map(|name| text(name)).collect();
    let number = |value: &str, times: usize| {
        format!(
            "<table:table-cell office:value-type='float' office:value='{value}' table:number-columns-repeated='{times}'>\
                 <office:annotation><text:p>a remark</text:p></office:annotation><text:p>{value} units</text:p></table:table-cell>"
        )
    };
    let row = |f: &str| {
        format!(
            "<table:table-row>{}{}{}{}{}<table:table-cell table:number-columns-repeated='16378'/></table:table-row>",
            number("20", 2),
            number("2.5", 1),
            number(f, 1),
            number("1.5", 1),
            number("1", 1)
        )
    };
    let blank = "<table:table-row table:number-rows-repeated='3'><table:table-cell table:number-columns-repeated='16384'/></table:table-row>";
    let rest = blank.replace("'3'", "'1048569'");
    let rows = format!("<table:table-row>{header}</table:table-row>{}{blank}{}{rest}", row("60"), row("61"));
    let table = read("t.ods", &libre(&rows), "sheet = 'T'").unwrap_or_else(|error| panic!("{error}"));
    let seen: Vec<_> = table.points.iter().map(|p| (p.line, p.frequency, p.speed, p.load)).collect();
    assert_eq!(seen, [(2, 60.0, 0.02, 20.0), (6, 61.0, 0.02, 20.0)]);
}

#[test]
fn a_workbook_takes_no_more_memory_than_a_table_of_text() {
    let refused = |bytes: &[u8]| read("t.xlsx", bytes, "").expect_err("too large");
    let cell = |at: &str| format!("<row><c r='{at}'><v>1</v></c></row>");
    for (rows, words) in [
        (cell("XFD1048576"), "row 1 has a cell XFD1048576"),
        ("<row r='1048576'><c r='XFD1048576'><v>1</v></c></row>".into(), "header"),
        (cell("XFE1"), "row 1 has a cell XFE1"),
        (cell("ZZZZZZZZZZ1"), "row 1 has a cell ZZZZZZZZZZ1"),
        ("<row r='99999999999'/>".into(), "there is no row 99999999999"),
        ("<row r='2'/><row r='1'/>".into(), "row 1 stands twice or too late"),
        ("<row><c r='B1'><v>1</v></c><c r='A1'><v>1</v></c></row>".into(), "in no order"),
        ("<row><c t='s'><v>7</v></c></row>".into(), "no shared text 7"),
        ("<row><c r='XFD'><v>1</v></c></row>".repeat(5000), "row 1 has a cell XFD"),
        (
            format!(
                "<row><c r='A1'><v>a</v></c><c r='XFD1'><v>b</v></c></row>{}",
                "<row><c><v>1</v></c></row>".repeat(5000)
            ),
            "too large",
        ),
    ] {
        let told = refused(&excel(&rows, ""));
        assert!(told.contains(words), "{rows:.99}: {told:.999}");
    }
    let bomb = " ".repeat(70 << 20);
    assert!(refused(&excel(&bomb, "")).contains("at most 67 MB are unpacked"));
    assert!(refused(&excel("", &bomb)).contains("at most 67 MB are unpacked"));
    let repeats = |rows: &str, columns: &str| {
        format!(
            "<table:table-row table:number-rows-repeated='{rows}'><table:table-cell office:value='1' table:number-columns-repeated='{columns}'/></table:table-row>"
        )
    };
    for (rows, columns, words) in [
        ("1", "999999999999", "beyond column 16384"),
        ("999999999999", "1", "more than 1048576 rows"),
        ("1000000", "16384", "too large"),
        ("-1", "1", "it repeats something -1 times"),
    ] {
        let told = read("t.ods", &libre(&repeats(rows, columns)), "sheet = 'T'").expect_err("too large");
        assert!(told.contains(words), "{told:.999}");
    }
}

#[test]
fn a_damaged_workbook_is_the_sound_one_or_refused() {
    let sound = read("t.xlsx", SHEET, "").expect("a sound workbook").points;
    let (mut refused, mut same) = (0, 0);
    for at in 0..SHEET.len() {
        for mask in [1, 0x40, 0xff] {
            let mut bytes = SHEET.to_vec();
            bytes[at] ^= mask;
            match read("t.xlsx", &bytes, "") {
                Ok(table) => {
                    assert_eq!(table.points, sound, "byte {at} ^ {mask}");
                    same += 1;
                }
                Err(_) => refused += 1,
            }
        }
    }
    assert!(refused > 1000 && same > 300, "{refused} refused, {same} the same");
    for length in 0..SHEET.len() {
        assert!(read("t.xlsx", &SHEET[..length], "").is_err(), "cut at {length}");
    }
    assert!(read("t.xls", b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "").expect_err("old").contains("password"));
}
