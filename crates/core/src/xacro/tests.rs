//! Expansions of small files, written out again as text.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;

use super::*;
use crate::system::MemorySystem;
use crate::xml::{self, Node};

/// Expands `main.xacro` of these files; the elements as text without spaces between them, and the findings.
fn expanded(files: &[(&str, &str)]) -> (String, String) {
    expanded_at("main.xacro", files)
}

/// Expands the file of this path, one of these files.
fn expanded_at(path: &str, files: &[(&str, &str)]) -> (String, String) {
    let mut system = MemorySystem::new();
    for (path, text) in files {
        system.insert(*path, *text);
    }
    let mut sources = Sources::new();
    let path = Path::new(path);
    let (root, mut found) = xml::load(&system, &mut sources, path);
    let (packages, arguments) = (BTreeMap::new(), BTreeMap::new());
    let given = Given { packages: &packages, arguments: &arguments };
    let (root, from_xacro) = expand(&system, &mut sources, path, &root.unwrap(), given);
    found.extend(from_xacro);
    let mut text = String::new();
    for node in &root.children {
        write_node(&mut text, node);
    }
    (text, found.to_plain_text(&sources))
}

fn write_node(out: &mut String, node: &Node) {
    match node {
        Node::Text(text, _) => out.push_str(text.trim()),
        Node::Element(e) => {
            write!(out, "<{}", e.name).unwrap();
            for a in &e.attributes {
                write!(out, " {}=\"{}\"", a.name, a.value).unwrap();
            }
            out.push('>');
            e.children.iter().for_each(|child| write_node(out, child));
            write!(out, "</{}>", e.name).unwrap();
        }
    }
}

/// What the body of a robot expands to, without any finding.
fn body(text: &str) -> String {
    let file = format!("<robot xmlns:xacro=\"http://ros.org/wiki/xacro\">{text}</robot>");
    let (text, found) = expanded(&[("main.xacro", &file)]);
    assert_eq!(found, "");
    text
}

/// The value of one expression.
fn value(expression: &str) -> String {
    let text = body(&format!("<a v=\"${{{expression}}}\"/>"));
    text.strip_prefix("<a v=\"").unwrap().strip_suffix("\"></a>").unwrap().to_owned()
}

#[test]
fn expressions_have_the_values_of_python() {
    let table = [
        ("1 + 2 * 3", "7"),
        ("(1 + 2) * 3", "9"),
        ("7 / 2", "3.5"),
        ("4 / 2", "2.0"),
        ("-7 // 2", "-4"),
        ("-7 % 3", "2"),
        ("2 ** -1", "0.5"),
        ("-2 ** 2", "-4"),
        ("2 ** 3 ** 2", "512"),
        ("1e-3 + .5", "0.501"),
        ("pi / 2", "1.5707963267948966"),
        ("-pi", "-3.141592653589793"),
        ("math.sin(pi / 6) + cos(0)", "1.5"),
        ("radians(180)", "3.141592653589793"),
        ("degrees(pi)", "180.0"),
        ("sqrt(2) * atan2(1, 1)", "1.1107207345395915"),
        ("'a' + 'b'", "ab"),
        ("1 if 2 &gt; 1 else 0", "1"),
        ("1 &lt; 2 &lt;= 2", "True"),
        ("not True or 3", "3"),
        ("'x' in ['x', 'y'] and 2 not in [1]", "True"),
        ("[1, 2, 3][-1]", "3"),
        ("{'k': 5}['k']", "5"),
        ("max(1, 2.5) - min([3, 4])", "-0.5"),
        ("round(2.675, 2)", "2.67"),
        ("int(2.9) + len('abc')", "5"),
        ("'a,b'.split(',')[1].upper()", "B"),
        ("str(1) + '_' + str(2.0)", "1_2.0"),
        ("True == 1", "True"),
        ("None == 0", "False"),
    ];
    for (expression, expected) in table {
        assert_eq!(value(expression), expected, "{expression}");
    }
}

#[test]
fn properties_are_lazy_and_scoped() {
    let text = body(
        "<xacro:property name=\"area\" value=\"${side * side}\"/><xacro:property name=\"side\" value=\"3\"/>
         <xacro:macro name=\"m\" params=\"side\"><b area=\"${area}\" side=\"${side}\"/>
         <xacro:property name=\"out\" value=\"${side + 1}\" scope=\"parent\"/></xacro:macro>
         <xacro:m side=\"5\"/><c out=\"${out}\"/>
         <xacro:property name=\"side\" value=\"${side + 1}\"/><d side=\"${side}\"/>",
    );
    assert_eq!(text, "<b area=\"9\" side=\"5\"></b><c out=\"6\"></c><d side=\"4\"></d>");
}

#[test]
fn macros_take_values_defaults_and_blocks() {
    let text = body(
        "<xacro:property name=\"outer\" value=\"o\"/>
         <xacro:macro name=\"link\" params=\"name prefix:='' outer:=^ none:=^|n *origin **rest\">
           <link name=\"${prefix}${name}\" of=\"${outer}${none}\"><xacro:insert_block name=\"origin\"/>
           <xacro:insert_block name=\"rest\"/></link></xacro:macro>
         <xacro:link name=\"a\"><origin xyz=\"${1 + 1} 0 0\"/><x><p/><q/></x></xacro:link>
         <xacro:call macro=\"link\" name=\"b\" prefix=\"l_\"><o/><x/></xacro:call>",
    );
    let expected = "<link name=\"a\" of=\"on\"><origin xyz=\"2 0 0\"></origin><p></p><q></q></link>\
                    <link name=\"l_b\" of=\"on\"><o></o></link>";
    assert_eq!(text, expected);
}

#[test]
fn conditions_computed_parts_and_escapes() {
    let text = body(
        "<xacro:arg name=\"real\" default=\"false\"/>
         <xacro:if value=\"$(arg real)\"><no/></xacro:if><xacro:unless value=\"$(arg real)\"><yes/></xacro:unless>
         <xacro:if value=\"${1 == 1.0}\"><one/></xacro:if>
         <xacro:element xacro:name=\"${'li' + 'nk'}\" a=\"1\"><xacro:attribute name=\"n\" value=\"${2}\"/></xacro:element>
         <t v=\"$${x} $$(y) $5\"/>",
    );
    assert_eq!(text, "<yes></yes><one></one><link a=\"1\" n=\"2\"></link><t v=\"${x} $(y) $5\"></t>");
}

#[test]
fn files_are_included_from_packages_and_yaml_is_read() {
    let (text, found) = expanded(&[
        (
            "main.xacro",
            "<robot xmlns:xacro=\"x\"><xacro:include filename=\"$(find parts)/urdf/part.xacro\"/><xacro:part/></robot>",
        ),
        (
            "parts/urdf/part.xacro",
            "<robot xmlns:xacro=\"x\"><xacro:macro name=\"part\" params=\"\">
             <xacro:property name=\"c\" value=\"${xacro.load_yaml('../config/c.yaml')}\"/>
             <p m=\"${c.mass}\" a=\"${c['limits']['upper']}\"/></xacro:macro></robot>",
        ),
        ("parts/config/c.yaml", "mass: 2.5\nlimits: {upper: !degrees 90}\n"),
    ]);
    assert_eq!((text.as_str(), found.as_str()), ("<p m=\"2.5\" a=\"1.5707963267948966\"></p>", ""));
}

#[test]
fn folders_stand_for_themselves_in_whatever_file_they_are_used() {
    let (text, found) = expanded_at(
        "robots/arm/urdf/arm.urdf.xacro",
        &[
            (
                "robots/arm/urdf/arm.urdf.xacro",
                "<robot xmlns:xacro=\"x\"><xacro:arg name=\"f\" default=\"$(dirname)/limits.yaml\"/>
                 <xacro:include filename=\"$(find arm)/macros/arm.xacro\"/>
                 <xacro:arm folder=\"$(find arm)/meshes\" limits=\"$(arg f)\"/></robot>",
            ),
            (
                "robots/arm/macros/arm.xacro",
                "<robot xmlns:xacro=\"x\"><xacro:include filename=\"./shape.xacro\"/>
                 <xacro:macro name=\"arm\" params=\"folder limits\">
                 <mesh filename=\"file://${folder}/a.stl\" v=\"${xacro.load_yaml(limits).v}\"/><xacro:shape/>
                 </xacro:macro></robot>",
            ),
            (
                "robots/arm/macros/shape.xacro",
                "<robot xmlns:xacro=\"x\"><xacro:macro name=\"shape\" params=\"\"><s f=\"a.stl\"/></xacro:macro></robot>",
            ),
            ("robots/arm/urdf/limits.yaml", "v: 3"),
        ],
    );
    let expected = "<mesh filename=\"package://arm/meshes/a.stl\" v=\"3\"></mesh><s f=\"a.stl\"></s>";
    assert_eq!((text.as_str(), found.as_str()), (expected, ""));
}

#[test]
fn faults_are_reported_where_they_are_written() {
    let (_, found) = expanded(&[(
        "main.xacro",
        "<robot xmlns:xacro=\"x\">
<xacro:macro name=\"m\" params=\"a\"><b v=\"${a + c}\"/></xacro:macro>
<xacro:m a=\"1\"/>
<xacro:m/>
<xacro:m a=\"1\" aa=\"2\"/>
<xacro:mm/>
<d v=\"${1 +}\" w=\"${1/0}\" x=\"${sin('a')}\" y=\"${\" z=\"$(env HOME)\"/>
<xacro:if value=\"perhaps\"/>
<xacro:insert_block name=\"none\"/>
</robot>",
    )]);
    let expected = "main.xacro:2:40: error[R0251]: `c` is not defined
main.xacro:4:1: error[R0250]: macro `m` is called without a value for `a`
main.xacro:5:20: error[R0250]: macro `m` has no parameter `aa`; did you mean `a`?
main.xacro:6:1: error[R0252]: there is no macro `mm`; did you mean `m`?
main.xacro:7:7: error[R0251]: the expression ends early
main.xacro:7:18: error[R0251]: division by zero
main.xacro:7:29: error[R0251]: `a` is not a number
main.xacro:7:45: error[R0251]: `${` is never closed with `}`
main.xacro:7:52: error[R0251]: `$(env ...)` is refused: a description must not depend on the environment
main.xacro:8:18: error[R0251]: `perhaps` is neither true nor false
main.xacro:9:1: error[R0252]: there is no block `none`
";
    assert_eq!(found, expected);
}

#[test]
fn what_a_missing_file_would_define_is_not_missed_again() {
    let (_, found) = expanded(&[(
        "main.xacro",
        "<robot xmlns:xacro=\"x\"><xacro:include filename=\"gone.xacro\"/><xacro:m/><a v=\"${p}\"/></robot>",
    )]);
    assert_eq!(found, "main.xacro:1:49: error[R0253]: there is no file gone.xacro\n");
}

#[test]
fn the_old_spelling_without_prefix_is_understood() {
    let (text, found) = expanded(&[(
        "main.xacro",
        "<robot xmlns:xacro=\"x\"><property name=\"p\" value=\"2\"/><macro name=\"m\" params=\"a\"><b v=\"${a * p}\"/>\
         </macro><m a=\"4\"/></robot>",
    )]);
    assert_eq!(text, "<b v=\"8\"></b>");
    assert!(found.starts_with("main.xacro:1:24: warning[R0250]") && found.lines().count() == 1, "{found}");
}

#[test]
fn endless_expansions_are_stopped() {
    let endless = [
        "<xacro:macro name=\"m\" params=\"\"><a><xacro:m/></a></xacro:macro><xacro:m/>",
        "<xacro:macro name=\"m\" params=\"\"><xacro:m/><xacro:m/></xacro:macro><xacro:m/>",
        "<xacro:property name=\"a\" value=\"${b}\"/><xacro:property name=\"b\" value=\"${a}\"/><c v=\"${a}\"/>",
        "<xacro:include filename=\"main.xacro\"/>",
    ];
    for text in endless {
        let file = format!("<robot xmlns:xacro=\"x\">{text}</robot>");
        let (_, found) = expanded(&[("main.xacro", &file)]);
        assert!(found.contains("error[R0254]") || found.contains("by itself"), "{text}: {found}");
    }
    let mut doubling = "<xacro:property name=\"p0\" value=\"xxxxxxxx\"/>".to_owned();
    for i in 1..40 {
        let before = i - 1;
        doubling += &format!("<xacro:property name=\"p{i}\" value=\"${{p{before}}}${{p{before}}}\"/>");
    }
    let file = format!("<robot xmlns:xacro=\"x\">{doubling}<a v=\"${{p39}}\"/></robot>");
    let (_, found) = expanded(&[("main.xacro", &file)]);
    assert!(found.contains("grows without end"), "{found}");
}

/// Few elements, each twice the one before: the expansion must stop before they fill the memory.
#[test]
fn doubling_in_expressions_and_blocks_is_stopped() {
    let chain = |step: &dyn Fn(usize) -> String| (1..60).map(step).collect::<String>();
    let property = |start: &str, value: &str| {
        let steps = chain(&|i| {
            let value = value.replace('P', &format!("p{}", i - 1));
            format!("<xacro:property name=\"p{i}\" value=\"${{{value}}}\"/>")
        });
        format!("<xacro:property name=\"p0\" value=\"{start}\"/>{steps}<a v=\"${{len(p59)}}\"/>")
    };
    let insert = |i: usize| format!("<xacro:insert_block name=\"b{i}\"/>").repeat(2);
    let blocks =
        chain(&|i| format!("<xacro:property name=\"b{i}\"><c>{}</c></xacro:property>", insert(i - 1)));
    let attribute = "x".repeat(20_000);
    let calls = chain(&|i| {
        let calls = format!("<xacro:m{}/>", i - 1).repeat(2);
        format!("<xacro:macro name=\"m{i}\" params=\"\">{calls}</xacro:macro>")
    });
    let endless = [
        property("xxxxxxxx", "P + P"),
        property("${[1]}", "P + P"),
        property("${[1]}", "[P, P]"),
        property("${{'k': 1}}", "{'a': P, 'b': P}"),
        format!("<xacro:property name=\"b0\"><d/></xacro:property>{blocks}{}", insert(59)),
        format!(
            "<xacro:macro name=\"m0\" params=\"\"><a v=\"{attribute}\"/></xacro:macro>{calls}<xacro:m59/>"
        ),
    ];
    for text in endless {
        let file = format!("<robot xmlns:xacro=\"x\">{text}</robot>");
        let (_, found) = expanded(&[("main.xacro", &file)]);
        assert!(found.contains("without end") || found.contains("does not end"), "{}: {found}", &text[..200]);
    }
}
