//! Teaching parts of the book: drawings, symbols ahead of equations, the worked operating point.
//!
//! Truth: the program's numbers next to those of the printed equations, the values of the vehicle file, the style sheet.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::collections::{BTreeMap, BTreeSet};
use std::fs::read_to_string;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use cvtcycle::config::setup::assumptions::value;
use cvtcycle::config::setup::{Options, load};
use cvtcycle_book::figures::files;
use cvtcycle_book::figures::worked::checked;
use cvtcycle_book::pictures;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/book")
}

/// Files with an extension in a folder of the book: name, text.
fn texts(below: &str, ending: &str) -> BTreeMap<String, String> {
    let entries = std::fs::read_dir(folder().join(below)).unwrap();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let names = names.filter(|name| name.ends_with(ending));
    let text = |name: &str| read_to_string(folder().join(below).join(name)).unwrap();
    names.map(|name| (name.clone(), text(&name))).collect()
}

/// Hand-made and generated drawings.
static DRAWINGS: LazyLock<BTreeMap<String, String>> = LazyLock::new(|| {
    let made = files(&folder().join("src")).unwrap().into_iter();
    let by_hand = texts("src/drawings", ".svg");
    made.filter(|(name, _)| name.ends_with(".svg"))
        .chain(by_hand)
        .collect()
});

/// Truth: the generator evaluates the equations of the pages independently, and gives the results of `cvtcycle belt` at the same point.
#[test]
fn val_the_worked_point_is_the_programs() {
    let all = checked().unwrap();
    assert!(all.len() > 20, "{}", all.len());
    for result in all {
        let off = (result.worked - result.program).abs();
        // The program adds a nanometre to the idle arc to avoid a division by zero: 1.4e-8 of the slip.
        assert!(
            off <= 1e-7 * result.program.abs(),
            "{}: {} by the page, {} by the program",
            result.name,
            result.worked,
            result.program
        );
    }
}

#[test]
fn every_colour_of_a_drawing_has_one_in_every_theme() {
    let css = read_to_string(folder().join("theme/equations.css")).unwrap();
    let mut lost = BTreeSet::new();
    for (name, svg) in DRAWINGS.iter() {
        for kind in ["fill", "stroke"] {
            for (at, mark) in svg.match_indices(&format!(" {kind}=\"#")) {
                let colour = &svg[at + mark.len() - 1..][..7];
                if !css.contains(&format!(".figures [{kind}=\"{colour}\"]")) {
                    lost.insert(format!("{name}: {kind} {colour}"));
                }
            }
        }
    }
    assert!(
        lost.is_empty(),
        "add to docs/book/theme/equations.css: {lost:?}"
    );
    let names = |rule: &str| -> BTreeSet<String> {
        let (_, rest) = css.split_once(rule).unwrap();
        let body = rest.split_once('}').unwrap().0;
        let names = body.split("--").skip(1);
        names
            .map(|name| name.split(':').next().unwrap().to_owned())
            .collect()
    };
    assert_eq!(
        names(":root {\n    --ink"),
        names(".coal, .navy, .ayu {\n    --ink")
    );
}

#[test]
fn drawings_by_hand_are_sound_and_have_symbols_for_symbols() {
    let all = texts("src/drawings", ".svg");
    assert!(all.len() > 10);
    for (name, svg) in &all {
        let document =
            roxmltree::Document::parse(svg).unwrap_or_else(|why| panic!("{name}: {why}"));
        let root = document.root_element();
        assert_eq!(root.attribute("role"), Some("img"), "{name}");
        let width: f64 = root.attribute("width").unwrap().parse().unwrap();
        assert!(width <= 400.0, "{name} does not fit a phone: {width}");
        for tag in ["title", "desc"] {
            let node = root.children().find(|node| node.has_tag_name(tag));
            // SVG elements have a namespace.
            let node = node.or_else(|| root.children().find(|n| n.tag_name().name() == tag));
            let text = node.and_then(|node| node.text()).unwrap_or_default();
            assert!(text.len() > 10, "{name}: {tag}");
        }
        for text in document
            .descendants()
            .filter(|node| node.tag_name().name() == "text")
        {
            let words: String = text.descendants().filter_map(|node| node.text()).collect();
            assert!(!words.contains(['_', '$', '\\']), "{name}: {words}");
        }
        assert!(
            !svg.contains("marker"),
            "{name}: markers share their names on a page"
        );
    }
}

/// A list of symbols comes before the first equation of its page.
#[test]
fn symbols_are_listed_before_they_are_used() {
    let mut with_list = 0;
    for (name, text) in texts("src", ".md") {
        let Some(list) = text.find("\n## Symbols") else {
            continue;
        };
        with_list += 1;
        let first = text.find("\n$$").unwrap_or(text.len());
        assert!(list < first, "{name}: an equation before its symbols");
    }
    assert!(with_list > 20, "{with_list}");
}

/// Every conductance and heat capacity of the vehicle file is on the sketch of the network with the same value.
#[test]
fn the_thermal_network_has_the_numbers_of_the_car() {
    let svg = &DRAWINGS["img/thermal_network.svg"];
    assert!(!svg.contains("{{"));
    let setup = load("rover_216_cvt", &Options::default()).unwrap();
    let mut count = 0;
    for info in setup.keys.iter().filter(|info| {
        info.key.starts_with("thermal.")
            && ["W/K", "kJ/K"].iter().any(|unit| info.unit.contains(unit))
    }) {
        assert!(svg.contains(&value(info)), "{}: {}", info.key, value(info));
        count += 1;
    }
    assert!(count > 12, "{count}");
}

#[test]
fn drawings_become_part_of_their_page() {
    let read = |name: &str| {
        let svg = "<svg xmlns=\"x\" width=\"400\">\n\n<path/>\n</svg>\n";
        match name {
            "a.svg" => Some(svg.to_owned()),
            "wide.svg" => Some(svg.replace("400", "880")),
            "bare.svg" => Some(svg.replace(" width=\"400\"", "")),
            _ => None,
        }
    };
    let page = "one\n\n![A](a.svg)\n![B](wide.svg)\n\ntwo\n\n```\n![A](a.svg)\n```\n";
    let made = pictures::page(page, read).unwrap();
    assert_eq!(
        made,
        "one\n\n<div class=\"figures\">\n\
         <figure class=\"sketch\"><svg xmlns=\"x\" width=\"400\"><path/></svg></figure>\n\
         <figure class=\"chart\" tabindex=\"0\"><svg xmlns=\"x\" width=\"880\"><path/></svg></figure>\n\
         </div>\n\ntwo\n\n```\n![A](a.svg)\n```\n"
    );
    let bad = pictures::page("![A](none.svg)\n![B](bare.svg)", read).unwrap_err();
    assert_eq!(
        bad,
        [
            "none.svg: no such drawing",
            "bare.svg: a drawing without width"
        ]
    );
}

/// Pages of the belt and of the losses, whose lists contain every symbol of their equations.
const LISTED: [&str; 17] = [
    "geometry",
    "tension",
    "slip",
    "bands",
    "film",
    "deflection",
    "belt",
    "pump",
    "input_shaft",
    "reverse_clutch",
    "seal_ring",
    "pulley_bearing",
    "gear_train",
    "final_drive",
    "launch",
    "torque_converter",
    "cold",
];
/// LaTeX commands that are not symbols.
const WORDS: [&str; 30] = [
    "frac",
    "tfrac",
    "min",
    "max",
    "ln",
    "sin",
    "cos",
    "tan",
    "arcsin",
    "tanh",
    "exp",
    "sqrt",
    "left",
    "right",
    "big",
    "cdot",
    "qquad",
    "quad",
    "le",
    "ge",
    "sum",
    "leftarrow",
    "to",
    "in",
    "circ",
    "sim",
    "textstyle",
    "hat",
    "dot",
    "pm",
];
/// Indices, the base of the exponential function, pi, differences and differentials.
const KNOWN: [&str; 7] = ["i", "p", "s", "e", "pi", "Delta", "d"];

/// Symbols of a formula without their indices.
fn symbols(tex: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut rest = tex;
    let group = |text: &str| match text.strip_prefix('{') {
        Some(inner) => 2 + inner.find('}').unwrap(),
        None => 0,
    };
    let word = |text: &str| {
        text.find(|c: char| !c.is_ascii_alphabetic())
            .unwrap_or(text.len())
    };
    while let Some(c) = rest.chars().next() {
        let used = match c {
            '_' if rest[1..].starts_with('\\') => {
                let name = 2 + word(&rest[2..]);
                name + group(&rest[name..])
            }
            '_' => 1 + group(&rest[1..]).max(1),
            '\\' => {
                let end = 1 + word(&rest[1..]);
                let name = &rest[1..end];
                if ["text", "mathrm", "begin", "end"].contains(&name) {
                    end + group(&rest[end..])
                } else {
                    if !name.is_empty() && !WORDS.contains(&name) {
                        found.insert(name.to_owned());
                    }
                    end.max(2)
                }
            }
            c => {
                if c.is_ascii_alphabetic() {
                    found.insert(c.to_string());
                }
                c.len_utf8()
            }
        };
        rest = rest.get(used..).unwrap_or_default();
    }
    found
}

#[test]
fn every_symbol_of_an_equation_is_in_the_list_of_its_page() {
    let mut lost = Vec::new();
    for page in LISTED {
        let text = read_to_string(folder().join(format!("src/{page}.md"))).unwrap();
        let (_, list) = text.split_once("\n## Symbols").unwrap();
        let list = list.split("\n## ").next().unwrap();
        let odd = |text: &str, mark: &str| -> BTreeSet<String> {
            let parts = text.split(mark).skip(1).step_by(2);
            parts.flat_map(symbols).collect()
        };
        let (listed, used) = (odd(list, "$"), odd(&text, "$$"));
        let missing = used.difference(&listed);
        let missing = missing.filter(|symbol| !KNOWN.contains(&symbol.as_str()));
        lost.extend(missing.map(|symbol| format!("{page}: {symbol}")));
    }
    assert!(lost.is_empty(), "{lost:?}");
    // By hand: indices and words are not symbols.
    let by_hand = symbols("T_\\text{cap} = \\frac{2 \\mu_{seg} R_s}{\\cos\\theta} \\text{ in Nm}");
    let expected = ["R", "T", "mu", "theta"].map(str::to_owned);
    assert_eq!(by_hand, BTreeSet::from(expected));
}
