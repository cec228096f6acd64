//! The XML of a workbook around its rows (ECMA-376).

/// Name of the second sheet; no table is named so.
const MEANINGS: &str = "meaning of columns";

const MAIN: &str = r#"xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main""#;
const RELATIONS: &str = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
const PACKAGE: &str = "http://schemas.openxmlformats.org/package/2006";
const SHEET_TYPE: &str = "application/vnd.openxmlformats-officedocument.spreadsheetml";
const DECLARATION: &str = "<?xml version=\"1.0\" encoding=\"UTF-8\" standalone=\"yes\"?>\n";

/// Everything around the sheets, by the name of its file.
pub fn frame(name: &str) -> Vec<(&'static str, String)> {
    let sheet = |k: u8| {
        format!(
            "<Override PartName=\"/xl/worksheets/sheet{k}.xml\" ContentType=\"{SHEET_TYPE}.worksheet+xml\"/>"
        )
    };
    let types = format!(
        "{DECLARATION}<Types xmlns=\"{PACKAGE}/content-types\">\
         <Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>\
         <Default Extension=\"xml\" ContentType=\"application/xml\"/>\
         <Override PartName=\"/xl/workbook.xml\" ContentType=\"{SHEET_TYPE}.sheet.main+xml\"/>{}{}\
         <Override PartName=\"/xl/styles.xml\" ContentType=\"{SHEET_TYPE}.styles+xml\"/></Types>",
        sheet(1),
        sheet(2)
    );
    let relation = |id: u8, kind: &str, target: &str| {
        format!("<Relationship Id=\"rId{id}\" Type=\"{RELATIONS}/{kind}\" Target=\"{target}\"/>")
    };
    let relations = |inner: &[String]| {
        format!(
            "{DECLARATION}<Relationships xmlns=\"{PACKAGE}/relationships\">{}</Relationships>",
            inner.concat()
        )
    };
    let workbook = format!(
        "{DECLARATION}<workbook {MAIN} xmlns:r=\"{RELATIONS}\"><bookViews><workbookView/></bookViews><sheets>\
         <sheet name=\"{}\" sheetId=\"1\" r:id=\"rId1\"/><sheet name=\"{MEANINGS}\" sheetId=\"2\" r:id=\"rId2\"/></sheets></workbook>",
        escaped(name)
    );
    let styles = format!(
        "{DECLARATION}<styleSheet {MAIN}><fonts count=\"2\"><font><sz val=\"11\"/><name val=\"Calibri\"/></font>\
         <font><b/><sz val=\"11\"/><name val=\"Calibri\"/></font></fonts>\
         <fills count=\"2\"><fill><patternFill patternType=\"none\"/></fill><fill><patternFill patternType=\"gray125\"/></fill></fills>\
         <borders count=\"1\"><border><left/><right/><top/><bottom/><diagonal/></border></borders>\
         <cellStyleXfs count=\"1\"><xf numFmtId=\"0\" fontId=\"0\" fillId=\"0\" borderId=\"0\"/></cellStyleXfs>\
         <cellXfs count=\"2\"><xf numFmtId=\"0\" fontId=\"0\" fillId=\"0\" borderId=\"0\" xfId=\"0\"/>\
         <xf numFmtId=\"0\" fontId=\"1\" fillId=\"0\" borderId=\"0\" xfId=\"0\" applyFont=\"1\"/></cellXfs>\
         <cellStyles count=\"1\"><cellStyle name=\"Normal\" xfId=\"0\" builtinId=\"0\"/></cellStyles></styleSheet>"
    );
    let inside = [
        relation(1, "worksheet", "worksheets/sheet1.xml"),
        relation(2, "worksheet", "worksheets/sheet2.xml"),
        relation(3, "styles", "styles.xml"),
    ];
    vec![
        ("[Content_Types].xml", types),
        (
            "_rels/.rels",
            relations(&[relation(1, "officeDocument", "xl/workbook.xml")]),
        ),
        ("xl/workbook.xml", workbook),
        ("xl/_rels/workbook.xml.rels", relations(&inside)),
        ("xl/styles.xml", styles),
    ]
}

/// A sheet up to its first row: header frozen, columns as wide as a name.
pub fn sheet_head(columns: usize, first: bool) -> String {
    let selected = if first { " tabSelected=\"1\"" } else { "" };
    format!(
        "{DECLARATION}<worksheet {MAIN}><sheetViews><sheetView{selected} workbookViewId=\"0\">\
         <pane ySplit=\"1\" topLeftCell=\"A2\" activePane=\"bottomLeft\" state=\"frozen\"/></sheetView></sheetViews>\
         <cols><col min=\"1\" max=\"{}\" width=\"24\" customWidth=\"1\"/></cols><sheetData>",
        columns.max(1)
    )
}

/// `A`, `B`, ... `Z`, `AA`, ...
pub fn column_letters(column: usize) -> String {
    let mut letters = Vec::new();
    let mut left = column + 1;
    while left > 0 {
        left -= 1;
        letters.push(char::from(b'A' + u8::try_from(left % 26).unwrap_or(0)));
        left /= 26;
    }
    letters.iter().rev().collect()
}

/// Text between tags. What XML cannot hold is written as `_x0001_`, as Excel does, and what looks like that is escaped itself.
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for (at, c) in text.char_indices() {
        match c {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            '_' if looks_escaped(&text.as_bytes()[at..]) => out += "_x005F_",
            '\t' | '\n' => out.push(c),
            '\u{FFFE}' | '\u{FFFF}' => out += &format!("_x{:04X}_", u32::from(c)),
            c if c < ' ' => out += &format!("_x{:04X}_", u32::from(c)),
            c => out.push(c),
        }
    }
    out
}

fn looks_escaped(bytes: &[u8]) -> bool {
    bytes.len() >= 7
        && bytes.starts_with(b"_x")
        && bytes[6] == b'_'
        && bytes[2..6].iter().all(u8::is_ascii_hexdigit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_lettered_as_in_excel() {
        let found: Vec<String> = [0, 25, 26, 51, 701, 702, 16_383]
            .into_iter()
            .map(column_letters)
            .collect();
        assert_eq!(found, ["A", "Z", "AA", "AZ", "ZZ", "AAA", "XFD"]);
    }

    #[test]
    fn letters_that_xml_cannot_hold_are_escaped_as_excel_does() {
        assert_eq!(
            escaped("a<b & \"c\">\n"),
            "a&lt;b &amp; &quot;c&quot;&gt;\n"
        );
        assert_eq!(
            escaped("\u{1}\r\u{FFFF}é\u{1F697}"),
            "_x0001__x000D__xFFFF_é\u{1F697}"
        );
        assert_eq!(escaped("_x0041_ _x00_ _"), "_x005F_x0041_ _x00_ _");
    }
}
