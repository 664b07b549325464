//! What a DXF has besides its entities: the header, and the tables and objects that readers insist on.

use super::pairs::Pairs;
use super::{Page, line_type_name};
use crate::drawing::Color;
use crate::write::layers::Layer;
use kurbo::Point;

/// Handle of the block that entities belong to.
pub(super) const MODEL_SPACE: u64 = 0x20;
const PAPER_SPACE: u64 = 0x21;
/// Handles of tables, of objects, and of what lies in tables.
const TABLES: u64 = 0x10;
const OBJECTS: u64 = 0x30;
const BLOCKS: u64 = 0x40;
const RECORDS: u64 = 0x50;
/// Layers and line types from here on.
const LAYERS: u64 = 0x1000;
const LINE_TYPES: u64 = 0x100_0000;
/// The first handle for entities.
pub(super) const ENTITIES: u64 = 0x200_0000;

/// `$INSUNITS`: none and millimetres.
const UNITS: [i64; 2] = [0, 4];

/// The sections before the entities, and the beginning of theirs.
pub(super) fn before(pairs: &mut Pairs, page: &Page, layers: &[Layer], line_types: &[[f64; 2]], next_handle: u64) {
    header(pairs, page, next_handle);
    section(pairs, "CLASSES");
    pairs.text(0, "ENDSEC");
    section(pairs, "TABLES");
    view_port(pairs, page);
    line_type_table(pairs, line_types);
    layer_table(pairs, layers);
    style_table(pairs);
    table(pairs, "VIEW", 3, 0);
    pairs.text(0, "ENDTAB");
    table(pairs, "UCS", 4, 0);
    pairs.text(0, "ENDTAB");
    table(pairs, "APPID", 5, 1);
    record(pairs, "APPID", RECORDS + 5, TABLES + 5, "AcDbRegAppTableRecord", "ACAD");
    pairs.int(70, 0);
    pairs.text(0, "ENDTAB");
    dimension_table(pairs);
    block_records(pairs);
    pairs.text(0, "ENDSEC");
    blocks(pairs);
    section(pairs, "ENTITIES");
}

/// The end of the entities and the sections after them.
pub(super) fn after(pairs: &mut Pairs) {
    pairs.text(0, "ENDSEC");
    section(pairs, "OBJECTS");
    dictionary(pairs, OBJECTS, 0);
    pairs.text(3, "ACAD_GROUP");
    pairs.handle(350, OBJECTS + 1);
    dictionary(pairs, OBJECTS + 1, OBJECTS);
    pairs.text(0, "ENDSEC");
    pairs.text(0, "EOF");
}

fn section(pairs: &mut Pairs, name: &str) {
    pairs.text(0, "SECTION");
    pairs.text(2, name);
}

fn header(pairs: &mut Pairs, page: &Page, next_handle: u64) {
    section(pairs, "HEADER");
    let mut variable = |name: &str| pairs.text(9, name);
    variable("$ACADVER");
    pairs.text(1, "AC1018");
    pairs.text(9, "$DWGCODEPAGE");
    pairs.text(3, "ANSI_1252");
    pairs.text(9, "$INSUNITS");
    pairs.int(70, UNITS[usize::from(page.metric)]);
    pairs.text(9, "$MEASUREMENT");
    pairs.int(70, 1);
    pairs.text(9, "$EXTMIN");
    pairs.point(10, Point::ZERO);
    pairs.text(9, "$EXTMAX");
    pairs.point(10, Point::new(page.width, page.height));
    pairs.text(9, "$LTSCALE");
    pairs.real(40, 1.0);
    pairs.text(9, "$LWDISPLAY");
    pairs.int(290, 1);
    pairs.text(9, "$HANDSEED");
    pairs.handle(5, next_handle);
    pairs.text(0, "ENDSEC");
}

/// The head of a table with a number of records.
fn table(pairs: &mut Pairs, name: &str, number: u64, records: usize) {
    pairs.text(0, "TABLE");
    pairs.text(2, name);
    pairs.handle(5, TABLES + number);
    pairs.handle(330, 0);
    pairs.text(100, "AcDbSymbolTable");
    pairs.int(70, records as i64);
}

/// The head of a record.
fn record(pairs: &mut Pairs, kind: &str, handle: u64, owner: u64, class: &str, name: &str) {
    pairs.text(0, kind);
    pairs.handle(if kind == "DIMSTYLE" { 105 } else { 5 }, handle);
    pairs.handle(330, owner);
    pairs.text(100, "AcDbSymbolTableRecord");
    pairs.text(100, class);
    pairs.text(2, name);
}

/// A view of the whole page.
fn view_port(pairs: &mut Pairs, page: &Page) {
    table(pairs, "VPORT", 0, 1);
    record(pairs, "VPORT", RECORDS, TABLES, "AcDbViewportTableRecord", "*ACTIVE");
    pairs.int(70, 0);
    pairs.flat_point(10, Point::ZERO);
    pairs.flat_point(11, Point::new(1.0, 1.0));
    pairs.flat_point(12, Point::new(0.5 * page.width, 0.5 * page.height));
    pairs.real(40, page.height.max(0.75 * page.width));
    pairs.real(41, 4.0 / 3.0);
    pairs.text(0, "ENDTAB");
}

fn line_type_table(pairs: &mut Pairs, line_types: &[[f64; 2]]) {
    table(pairs, "LTYPE", 1, 3 + line_types.len());
    let mut plain = |k: u64, name: &str| {
        record(pairs, "LTYPE", RECORDS + 16 + k, TABLES + 1, "AcDbLinetypeTableRecord", name);
        pairs.int(70, 0);
        pairs.text(3, "");
        pairs.int(72, 65);
        pairs.int(73, 0);
        pairs.real(40, 0.0);
    };
    ["ByBlock", "ByLayer", "Continuous"].iter().zip(0..).for_each(|(name, k)| plain(k, name));
    for (k, [dash, gap]) in line_types.iter().enumerate() {
        let handle = LINE_TYPES + k as u64;
        record(pairs, "LTYPE", handle, TABLES + 1, "AcDbLinetypeTableRecord", &line_type_name(k));
        pairs.int(70, 0);
        pairs.text(3, &format!("dashes of {dash}, gaps of {gap}"));
        pairs.int(72, 65);
        pairs.int(73, 2);
        pairs.real(40, dash + gap);
        for length in [*dash, -gap] {
            pairs.real(49, length);
            pairs.int(74, 0);
        }
    }
    pairs.text(0, "ENDTAB");
}

fn layer_table(pairs: &mut Pairs, layers: &[Layer]) {
    table(pairs, "LAYER", 2, 1 + layers.len());
    let mut layer = |k: usize, name: &str, color: Option<Color>| {
        record(pairs, "LAYER", LAYERS + k as u64, TABLES + 2, "AcDbLayerTableRecord", name);
        pairs.int(70, 0);
        pairs.int(62, color.map_or(7, nearest_index));
        color.iter().for_each(|color| pairs.int(420, true_color(*color)));
        pairs.text(6, "Continuous");
        pairs.int(370, -3);
    };
    layer(0, "0", None);
    layers.iter().enumerate().for_each(|(k, l)| layer(k + 1, &l.name(), Some(l.color)));
    pairs.text(0, "ENDTAB");
}

fn true_color(Color([r, g, b]): Color) -> i64 {
    i64::from(u32::from_be_bytes([0, r, g, b]))
}

/// The nearest of the nine colours that every program knows by number; 7 is black or white, whichever is seen.
fn nearest_index(color: Color) -> i64 {
    const KNOWN: [([u8; 3], i64); 9] = [
        ([255, 0, 0], 1),
        ([255, 255, 0], 2),
        ([0, 255, 0], 3),
        ([0, 255, 255], 4),
        ([0, 0, 255], 5),
        ([255, 0, 255], 6),
        ([0, 0, 0], 7),
        ([128, 128, 128], 8),
        ([192, 192, 192], 9),
    ];
    let distance = |&(rgb, _): &([u8; 3], i64)| Color(rgb).distance(color);
    KNOWN.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).map_or(7, |known| known.1)
}

fn style_table(pairs: &mut Pairs) {
    table(pairs, "STYLE", 6, 1);
    record(pairs, "STYLE", RECORDS + 6, TABLES + 6, "AcDbTextStyleTableRecord", "Standard");
    pairs.int(70, 0);
    [(40, 0.0), (41, 1.0), (50, 0.0)].iter().for_each(|&(code, value)| pairs.real(code, value));
    pairs.int(71, 0);
    pairs.real(42, 2.5);
    pairs.text(3, "txt");
    pairs.text(4, "");
    pairs.text(0, "ENDTAB");
}

fn dimension_table(pairs: &mut Pairs) {
    table(pairs, "DIMSTYLE", 7, 1);
    pairs.text(100, "AcDbDimStyleTable");
    record(pairs, "DIMSTYLE", RECORDS + 7, TABLES + 7, "AcDbDimStyleTableRecord", "Standard");
    pairs.int(70, 0);
    pairs.text(0, "ENDTAB");
}

/// The two blocks that every file has: what is drawn, and the sheet that nothing is on.
const SPACES: [(&str, u64); 2] = [("*Model_Space", MODEL_SPACE), ("*Paper_Space", PAPER_SPACE)];

fn block_records(pairs: &mut Pairs) {
    table(pairs, "BLOCK_RECORD", 8, SPACES.len());
    for (name, handle) in SPACES {
        record(pairs, "BLOCK_RECORD", handle, TABLES + 8, "AcDbBlockTableRecord", name);
        pairs.handle(340, 0);
    }
    pairs.text(0, "ENDTAB");
}

fn blocks(pairs: &mut Pairs) {
    section(pairs, "BLOCKS");
    for (k, (name, owner)) in SPACES.into_iter().enumerate() {
        let mut entity = |kind: &str, handle: u64, class: &str| {
            pairs.text(0, kind);
            pairs.handle(5, handle);
            pairs.handle(330, owner);
            pairs.text(100, "AcDbEntity");
            pairs.text(8, "0");
            pairs.text(100, class);
            if kind == "BLOCK" {
                pairs.text(2, name);
                pairs.int(70, 0);
                pairs.point(10, Point::ZERO);
                pairs.text(3, name);
                pairs.text(1, "");
            }
        };
        let handle = BLOCKS + 2 * k as u64;
        entity("BLOCK", handle, "AcDbBlockBegin");
        entity("ENDBLK", handle + 1, "AcDbBlockEnd");
    }
    pairs.text(0, "ENDSEC");
}

fn dictionary(pairs: &mut Pairs, handle: u64, owner: u64) {
    pairs.text(0, "DICTIONARY");
    pairs.handle(5, handle);
    pairs.handle(330, owner);
    pairs.text(100, "AcDbDictionary");
    pairs.int(281, 1);
}
