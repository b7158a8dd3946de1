//! Faults and repairs, and agreement with a strict parser where there is nothing to repair.

use std::path::Path;

use super::*;
use crate::diag::Sources;

fn read(text: &str) -> (Option<Element>, String) {
    let mut sources = Sources::new();
    let file = sources.add("f", text);
    let (root, found) = parse(text, file, Limits { depth: 8, bytes: 10_000 });
    (root, found.to_plain_text(&sources))
}

#[test]
fn every_fault_of_a_text_is_told() {
    let table = [
        ("<a><b></a>", "f:1:4: error[R0201]: `<b>` is not closed before `</a>`\n"),
        ("<a><bcd></bdc></a>", "f:1:9: error[R0201]: `</bdc>` closes nothing; the open element is `<bcd>`\n"),
        ("<a x=1 y='2'/>", "f:1:4: error[R0201]: the value of `x` is not in quotes\n"),
        ("<a x='1' x='2'/>", "f:1:10: error[R0201]: attribute `x` is given twice\n"),
        ("<a x/>", "f:1:4: error[R0201]: attribute `x` has no value\n"),
        (
            "<a x='1><b/></a>",
            "f:1:4: error[R0201]: the value of `x` has no closing quote before the next `<`\n",
        ),
        (
            "<a>&nbsp;</a>",
            "f:1:4: error[R0201]: `&` that names no character; write `&amp;` for the character\n",
        ),
        ("<a>1 < 2</a>", "f:1:6: error[R0201]: `<` that starts no tag; write `&lt;` for the character\n"),
        (
            "<a><!-- </a>",
            "f:1:4: error[R0201]: this comment never ends with `-->`\nf:1:1: error[R0201]: `<a>` is never closed\n",
        ),
        ("<!-- only this -->\n", "f:1:1: error[R0201]: there is no XML element in this file\n"),
        ("x<a/>", "f:1:1: error[R0201]: text before the first element\n"),
        ("<a>\u{1}</a>", "f:1:4: error[R0201]: control character '\\u{1}'\n"),
        (
            "<a>\n <b",
            "f:2:2: error[R0201]: the tag `<b` never ends with `>`\nf:2:2: error[R0201]: `<b>` is never closed\nf:1:1: error[R0201]: `<a>` is never closed\n",
        ),
    ];
    for (text, expected) in table {
        assert_eq!(read(text).1, expected, "{text}");
    }
}

#[test]
fn what_has_one_meaning_is_repaired() {
    let table = [
        (" <?xml version='1.0'?><a/>", "f:1:2: warning[R0202]"),
        ("<?xml version='0.0'?><a/>", "f:1:1: warning[R0202]"),
        ("<a/><b/>", "f:1:5: warning[R0202]"),
        ("<a><!-- -- --></a>", "f:1:4: warning[R0202]"),
        ("<a><p:b/><p:c/></a>", "f:1:4: warning[R0203]"),
        ("\u{feff}<?xml version=\"1.0\"?><!DOCTYPE a [<!ELEMENT a ANY>]><a/><!-- end -->\n", ""),
        ("<a xmlns:p='q'><p:b p:c='1'/><![CDATA[<&]]></a>", ""),
    ];
    for (text, expected) in table {
        let (root, found) = read(text);
        assert_eq!(root.unwrap().name, "a");
        assert!(
            found.starts_with(expected) && found.lines().count() == usize::from(!expected.is_empty()),
            "{found}"
        );
    }
}

#[test]
fn depth_length_and_number_of_faults_are_bounded() {
    assert!(read(&"<a>".repeat(100_000)).1.contains("error[R0206]"));
    assert!(read(&"<a>".repeat(20)).1.contains("error[R0206]: elements are nested more than 8 deep"));
    let attributes: String = (0..2000).map(|i| format!(" a{i}=''")).collect();
    let limits = Limits { depth: 8, bytes: 1 << 20 };
    let mut sources = Sources::new();
    let text = format!("<a{attributes}/>");
    let (_, found) = parse(&text, sources.add("f", text.as_str()), limits);
    assert!(found.to_plain_text(&sources).contains("error[R0206]: `<a>` has more than 1000 attributes"));
    let faults = read(&format!("<a>{}</a>", "&x;".repeat(3_000))).1.lines().count();
    assert_eq!(faults, 60);
}

#[test]
fn conflicts_are_errors_and_the_first_side_is_read() {
    let mut system = crate::system::MemorySystem::new();
    system.insert("f", "<a>\n<<<<<<< HEAD\n<b x=\"1\"/>\n=======\n<c\n>>>>>>> other\n<d></a>\n");
    let mut sources = Sources::new();
    let (root, found) = load(&system, &mut sources, Path::new("f"));
    let names: Vec<String> = root.unwrap().elements().map(|e| e.name.clone()).collect();
    assert_eq!(names, ["b", "d"]);
    let text = found.to_plain_text(&sources);
    assert!(text.starts_with("f:2:1: error[R0204]") && text.contains("\nf:7:1: error[R0201]"), "{text}");
}

#[test]
fn other_encodings_are_read() {
    let utf16: Vec<u8> = "\u{feff}<a b=\"é\"/>".encode_utf16().flat_map(u16::to_le_bytes).collect();
    assert!(decode(&utf16).0.contains("b=\"é\""));
    assert_eq!(decode(b"ab\xff<").1, Some(2));
}

/// Files of the real data that a strict parser accepts: both trees must be the same.
#[test]
#[allow(clippy::print_stderr)] // tells that it was skipped
fn agrees_with_a_strict_parser() {
    let given = std::env::var_os("ROBOTC_SHARED_DATA").map(std::path::PathBuf::from);
    let folder = given.unwrap_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"));
    let Ok(entries) = std::fs::read_dir(folder.join("arms")) else {
        eprintln!("skipped: shared data not present");
        return;
    };
    let mut compared = 0;
    for path in entries.map(|e| e.unwrap().path()).filter(|p| p.extension().is_some_and(|e| e == "urdf")) {
        let text = std::fs::read_to_string(&path).unwrap();
        let Ok(strict) = roxmltree::Document::parse(&text) else { continue };
        let mut sources = Sources::new();
        let file = sources.add("f", text.as_str());
        let (root, found) = parse(&text, file, Limits::default());
        assert!(!found.has_errors(), "{}: {}", path.display(), found.to_plain_text(&sources));
        same(&root.unwrap(), strict.root_element(), &path);
        compared += 1;
    }
    assert!(compared > 100, "{compared}");
}

fn same(ours: &Element, theirs: roxmltree::Node<'_, '_>, path: &Path) {
    let local = |name: &str| name.rsplit(':').next().unwrap_or_default().to_owned();
    assert_eq!(local(&ours.name), theirs.tag_name().name(), "{}", path.display());
    let attributes: Vec<(String, &str)> = ours
        .attributes
        .iter()
        .filter(|a| a.name != "xmlns" && !a.name.starts_with("xmlns:"))
        .map(|a| (local(&a.name), a.value.as_str()))
        .collect();
    let strict: Vec<(String, &str)> = theirs.attributes().map(|a| (a.name().to_owned(), a.value())).collect();
    assert_eq!(attributes, strict, "{}", path.display());
    assert_eq!(ours.span.start, theirs.range().start, "{}", path.display());
    let children: Vec<_> = theirs.children().filter(roxmltree::Node::is_element).collect();
    assert_eq!(ours.elements().count(), children.len(), "{}", path.display());
    for (ours, theirs) in ours.elements().zip(children) {
        same(ours, theirs, path);
    }
}
