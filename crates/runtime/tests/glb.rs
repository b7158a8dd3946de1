//! An independent reader of binary glTF checks what is written: chunks, alignment, ranges, bounds, hierarchy.

mod scene;

use robotc_runtime::view;
use serde_json::Value;

/// The two chunks of a binary glTF file.
fn chunks(file: &[u8]) -> (Value, &[u8]) {
    let word = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().expect("four bytes")) as usize;
    assert_eq!(&file[..4], b"glTF");
    assert_eq!((word(4), word(8)), (2, file.len()), "version and length");
    let text = word(12);
    assert_eq!((&file[16..20], text % 4), (&b"JSON"[..], 0));
    let contents = serde_json::from_slice(&file[20..20 + text]).expect("the first chunk is JSON");
    let start = 20 + text;
    assert_eq!((&file[start + 4..start + 8], word(start) % 4), (&b"BIN\0"[..], 0));
    let block = &file[start + 8..];
    assert_eq!(word(start), block.len());
    (contents, block)
}

fn integer(value: &Value) -> usize {
    value.as_u64().unwrap_or_else(|| panic!("{value} is no index")) as usize
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

fn width(kind: &Value) -> usize {
    match kind.as_str() {
        Some("SCALAR") => 1,
        Some("VEC3") => 3,
        Some("VEC4") => 4,
        other => panic!("unexpected accessor type {other:?}"),
    }
}

/// The components of an accessor, after checks that it stays in its view, and the view in the block.
fn components(contents: &Value, block: &[u8], accessor: usize) -> Vec<f64> {
    let accessor = &contents["accessors"][accessor];
    let view = &contents["bufferViews"][integer(&accessor["bufferView"])];
    let (offset, length) = (integer(&view["byteOffset"]), integer(&view["byteLength"]));
    assert!(offset % 4 == 0 && offset + length <= block.len(), "a view inside the block");
    assert_eq!(
        length,
        4 * width(&accessor["type"]) * integer(&accessor["count"]),
        "an accessor fills its view"
    );
    let words = block[offset..offset + length].chunks_exact(4).map(|b| [b[0], b[1], b[2], b[3]]);
    match integer(&accessor["componentType"]) {
        5126 => words.map(|b| f64::from(f32::from_le_bytes(b))).collect(),
        5125 => words.map(|b| f64::from(u32::from_le_bytes(b))).collect(),
        other => panic!("unexpected component type {other}"),
    }
}

fn check_bounds(contents: &Value, block: &[u8], index: usize) {
    let accessor = &contents["accessors"][index];
    let width = width(&accessor["type"]);
    let found = components(contents, block, index);
    for axis in 0..width {
        let along = found.iter().skip(axis).step_by(width).copied();
        let (low, high) = along.fold((f64::MAX, f64::MIN), |(l, h), x| (l.min(x), h.max(x)));
        assert_eq!(accessor["min"][axis].as_f64(), Some(low), "accessor {index}");
        assert_eq!(accessor["max"][axis].as_f64(), Some(high), "accessor {index}");
    }
}

#[test]
fn what_is_written_is_valid() {
    let recording = scene::sliding_blocks();
    let file = view::glb(&recording);
    let (contents, block) = chunks(&file);
    assert_eq!(integer(&contents["buffers"][0]["byteLength"]), block.len());

    let meshes = list(&contents["meshes"]);
    assert!(!meshes.is_empty());
    for primitive in meshes.iter().flat_map(|mesh| list(&mesh["primitives"])) {
        let positions = integer(&primitive["attributes"]["POSITION"]);
        check_bounds(&contents, block, positions);
        let count = integer(&contents["accessors"][positions]["count"]);
        for attribute in primitive["attributes"].as_object().expect("attributes").values() {
            assert_eq!(integer(&contents["accessors"][integer(attribute)]["count"]), count);
        }
        let indices = components(&contents, block, integer(&primitive["indices"]));
        assert!(indices.iter().all(|&i| (i as usize) < count), "an index past the vertices");
        let corners = if primitive.get("mode").is_some() { 2 } else { 3 };
        assert_eq!(indices.len() % corners, 0);
        if let Some(normals) = primitive["attributes"].get("NORMAL") {
            for n in components(&contents, block, integer(normals)).chunks(3) {
                let length = n.iter().map(|x| x * x).sum::<f64>();
                assert!((length - 1.0).abs() < 1e-5, "a normal of length {length}");
            }
        }
        assert!(integer(&primitive["material"]) < list(&contents["materials"]).len());
    }

    let nodes = list(&contents["nodes"]);
    let mut parents = vec![0; nodes.len()];
    for child in nodes.iter().flat_map(|node| list(&node["children"])) {
        parents[integer(child)] += 1;
    }
    assert_eq!(parents[0], 0, "the root has no parent");
    assert!(parents[1..].iter().all(|&n| n == 1), "every other node has one parent");
    assert!(nodes.iter().all(|node| node.get("mesh").is_none_or(|mesh| integer(mesh) < meshes.len())));
}

#[test]
fn the_animation_holds_the_recorded_poses() {
    let recording = scene::sliding_blocks();
    let file = view::glb(&recording);
    let (contents, block) = chunks(&file);
    let animation = &contents["animations"][0];
    let mut moved = Vec::new();
    for channel in list(&animation["channels"]) {
        let sampler = &animation["samplers"][integer(&channel["sampler"])];
        let (input, output) = (integer(&sampler["input"]), integer(&sampler["output"]));
        check_bounds(&contents, block, input);
        let times = components(&contents, block, input);
        let values = components(&contents, block, output);
        assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "times increase");
        let name = contents["nodes"][integer(&channel["target"]["node"])]["name"].as_str().expect("a name");
        let node = recording.nodes().position(|n| n.name == name).expect("a node of this name");
        let path = channel["target"]["path"].as_str().expect("a path");
        let wide = if path == "translation" { 3 } else { 4 };
        assert_eq!(values.len(), wide * times.len());
        for (&time, value) in times.iter().zip(values.chunks(wide)) {
            let pose = recording.nodes()[node].track.at(time);
            let expected = match path {
                "translation" => pose.translation.vector.as_slice().to_vec(),
                _ => pose.rotation.coords.as_slice().to_vec(),
            };
            let error = value.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(error < 1e-6, "{name} {path} at {time}: {value:?} for {expected:?}");
        }
        moved.push((name.to_owned(), path.to_owned()));
    }
    for path in ["translation", "rotation"] {
        assert!(moved.contains(&("red".to_owned(), path.to_owned())));
    }
    assert!(moved.iter().all(|(name, _)| name != "table"), "what stands still has no channel");
}

#[test]
fn the_same_recording_gives_the_same_bytes() {
    assert_eq!(view::glb(&scene::sliding_blocks()), view::glb(&scene::sliding_blocks()));
    assert_eq!(view::html(&scene::sliding_blocks()), view::html(&scene::sliding_blocks()));
}

#[test]
fn an_empty_recording_is_a_file_too() {
    let (contents, block) = {
        let file = view::glb(&robotc_runtime::record::Recording::new("nothing"));
        let (contents, block) = chunks(&file);
        (contents, block.to_vec())
    };
    assert!(block.is_empty() && contents.get("meshes").is_none() && contents.get("buffers").is_none());
}
