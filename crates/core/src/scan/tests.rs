//! Every format gives the same points or heights, and no cut or change of a file makes a reader panic.

use super::*;
use proptest::prelude::*;

const POINTS: [[f64; 3]; 3] = [[1.0, 2.0, 3.5], [-0.25, 0.0, 1e3], [0.5, -7.0, 0.125]];

fn singles(big_endian: bool) -> Vec<u8> {
    let bytes = |x: f64| if big_endian { (x as f32).to_be_bytes() } else { (x as f32).to_le_bytes() };
    POINTS.iter().flatten().flat_map(|x| bytes(*x)).collect()
}

fn npy(descr: &str, order: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': {shape}, }}\n");
    [b"\x93NUMPY\x01\x00", &(header.len() as u16).to_le_bytes()[..], header.as_bytes(), data].concat()
}

/// The points above in every format.
fn point_files() -> Vec<Vec<u8>> {
    let ply = |form: &str, body: &[u8]| {
        let header = format!(
            "ply\nformat {form} 1.0\ncomment made by hand\nelement vertex 3\nproperty float x\nproperty float y\n\
             property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
        );
        [header.as_bytes(), body].concat()
    };
    let text = "1 2 3.5\n-0.25 0 1e3\n0.5 -7 0.125\n";
    let pcd = |data: &str, body: &[u8]| {
        let header = format!(
            "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 3\nHEIGHT 1\n\
             VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\nDATA {data}\n"
        );
        [header.as_bytes(), body].concat()
    };
    // Each coordinate of all points in turn, plain in LZF's sense: a byte of 31 for 32 that follow.
    let columns: Vec<u8> =
        (0..3).flat_map(|k| POINTS.iter().flat_map(move |p| (p[k] as f32).to_le_bytes())).collect();
    let mut packed = vec![31];
    packed.extend(&columns[..32]);
    packed.push(3);
    packed.extend(&columns[32..]);
    let sizes = [(packed.len() as u32).to_le_bytes(), (columns.len() as u32).to_le_bytes()].concat();
    let doubles: Vec<u8> = POINTS.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    let by_column: Vec<u8> =
        (0..3).flat_map(|k| POINTS.iter().flat_map(move |p| p[k].to_be_bytes())).collect();
    let face: &[u8] = &[3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0];
    vec![
        text.as_bytes().to_vec(),
        b"\xef\xbb\xbfx,y,z,intensity\n1,2,3.5,9\n-0.25,0,1e3,9\n# far\n0.5;-7;0.125;9\n".to_vec(),
        format!("3\n{text}").into_bytes(),
        ply("ascii", format!("{text}3 0 1 2\n").as_bytes()),
        ply("binary_little_endian", &[&singles(false)[..], face].concat()),
        ply("binary_big_endian", &[&singles(true)[..], face].concat()),
        pcd("ascii", text.as_bytes()),
        pcd("binary", &singles(false)),
        pcd("binary_compressed", &[&sizes[..], &packed].concat()),
        npy("<f8", "False", "(3, 3)", &doubles),
        npy(">f8", "True", "(3, 3)", &by_column),
        npy("<f4", "False", "(1, 3, 3)", &singles(false)),
    ]
}

fn png_file(depth: BitDepth, rows: &[u8], width: u32) -> Vec<u8> {
    let mut file = Vec::new();
    let height = rows.len() as u32 / (width * if depth == BitDepth::Sixteen { 2 } else { 1 });
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(depth);
    encoder.write_header().unwrap().write_image_data(rows).unwrap();
    file
}

use png::BitDepth;

fn grid_files() -> Vec<Vec<u8>> {
    let values: [u16; 6] = [0, 1, 2, 300, 65535, 5];
    let wide: Vec<u8> = values.iter().flat_map(|v| v.to_be_bytes()).collect();
    let little: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
    vec![
        png_file(BitDepth::Sixteen, &wide, 3),
        npy("<u2", "False", "(2, 3)", &little),
        b"0 1 2\n300 65535 5\n".to_vec(),
        b"0,1,2\n300, 65535, 5\n".to_vec(),
    ]
}

#[test]
fn every_format_gives_the_same_points() {
    for file in point_files() {
        let found = points(&file);
        let expected: Vec<Point3<f64>> = POINTS.iter().copied().map(Point3::from).collect();
        let shown = String::from_utf8_lossy(&file).into_owned();
        assert_eq!(found, Ok(Points { points: expected, dropped: 0 }), "{shown}");
    }
}

#[test]
fn every_format_gives_the_same_heights() {
    for file in grid_files() {
        let found = grid(&file).unwrap();
        assert_eq!((found.columns, found.values.as_slice()), (3, &[0.0, 1.0, 2.0, 300.0, 65535.0, 5.0][..]));
    }
    let small = grid(&png_file(BitDepth::Eight, &[7, 9, 255, 0], 2)).unwrap();
    assert_eq!((small.values, small.full), (vec![7.0, 9.0, 255.0, 0.0], Some(255.0)));
    let gaps = grid(b"1,,nan\n2,3,4\n").unwrap();
    assert_eq!(
        gaps.values.iter().map(|v| v.is_nan()).collect::<Vec<_>>(),
        [false, true, true, false, false, false]
    );
}

#[test]
fn points_without_a_place_are_left_out() {
    let found = points(b"1 2 3\nnan 0 0\n4 5 inf\n").unwrap();
    assert_eq!((found.points.len(), found.dropped), (1, 2));
    assert_eq!(points(b"nan 0 0\n"), Err(ScanError::Empty("points")));
}

#[test]
fn what_is_wrong_is_said() {
    let message = |bytes: &[u8]| points(bytes).unwrap_err().to_string();
    let cases: &[(&[u8], &str)] = &[
        (b"", "holds no points"),
        (b"\xff\xfe\x00", "not a PLY, PCD or NPY file"),
        (b"hello\nworld\n", "not a PLY, PCD or NPY file"),
        (b"1 2 3\n4 5\n", "line 2: a point needs three numbers"),
        (b"ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n",
         "says 2 of `vertex`, but ends after 1"),
        (b"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n", "have no `y`"),
        (b"ply\nformat ascii 1.0\nelement vertex 99999999999\nproperty float x\nend_header\n0\n", "holds more than 16777216 points"),
        (b"VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 2\nDATA binary\n0000", "says 2 points, but ends after 0"),
        (b"VERSION 0.7\nFIELDS x y z\nSIZE 4 4 3\nTYPE F F F\nPOINTS 2\nDATA binary\n0000", "field `z`"),
    ];
    for (bytes, expected) in cases {
        assert!(message(bytes).contains(expected), "{}", message(bytes));
    }
    assert!(message(&npy("<f8", "False", "(2, 2)", &[0; 32])).contains("three columns"));
    assert!(message(&npy("<f8", "False", "(2, 3)", &[0; 47])).contains("ends early"));
    assert!(message(&npy("|O", "False", "(2, 3)", &[0; 64])).contains("plain numbers"));
    assert!(grid(b"1 2\n3\n").unwrap_err().to_string().contains("line 2 has 1 numbers, those above have 2"));
}

#[test]
fn no_cut_makes_a_reader_panic() {
    for file in point_files().iter().chain(&grid_files()) {
        for end in 0..file.len() {
            let _ = (points(&file[..end]), grid(&file[..end]));
        }
    }
}

proptest! {
    #[test]
    fn no_change_makes_a_reader_panic(
        pick in 0..16_usize,
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
    ) {
        let mut file = point_files().into_iter().chain(grid_files()).nth(pick).unwrap();
        for (at, byte) in changes {
            let at = at.index(file.len());
            file[at] = byte;
        }
        if let Ok(found) = points(&file) {
            prop_assert!(found.points.iter().all(|p| p.iter().all(|x| x.is_finite())));
        }
        if let Ok(found) = grid(&file) {
            prop_assert_eq!(found.values.len() % found.columns, 0);
        }
    }
}
