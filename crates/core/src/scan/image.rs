//! Grey PNG images.

use std::io::Cursor;

use png::{BitDepth, ColorType, Decoder, Limits};

use super::{Grid, ScanError};
use crate::geom::HeightField;

pub(super) fn is_png(bytes: &[u8]) -> bool {
    bytes.starts_with(b"\x89PNG\r\n\x1a\n")
}

/// Values as they are stored; what is fully transparent has none.
pub(super) fn read(bytes: &[u8]) -> Result<Grid, ScanError> {
    let malformed = |error: png::DecodingError| ScanError::Malformed(format!("the PNG file: {error}"));
    // An image of the most samples, two bytes and their transparency each.
    let limits = Limits { bytes: 8 * HeightField::MOST_SAMPLES };
    let mut reader = Decoder::new_with_limits(Cursor::new(bytes), limits).read_info().map_err(malformed)?;
    let info = reader.info();
    let (width, height) = (info.width as usize, info.height as usize);
    let (colour, depth) = (info.color_type, info.bit_depth);
    if width.saturating_mul(height) > HeightField::MOST_SAMPLES {
        return Err(ScanError::TooLarge(HeightField::MOST_SAMPLES, "samples"));
    }
    let channels = match colour {
        ColorType::Grayscale => 1,
        ColorType::GrayscaleAlpha => 2,
        ColorType::Rgb | ColorType::Rgba | ColorType::Indexed => {
            return Err(ScanError::Malformed("the PNG file is in colour; heights are grey".to_owned()));
        }
    };
    let Some(size) = reader.output_buffer_size() else {
        return Err(ScanError::TooLarge(HeightField::MOST_SAMPLES, "samples"));
    };
    let mut data = vec![0; size];
    reader.next_frame(&mut data).map_err(malformed)?;
    let bits = depth as usize;
    let row_bytes = (width * channels * bits).div_ceil(8);
    let value = |row: &[u8], i: usize| match depth {
        BitDepth::Sixteen => f64::from(u16::from_be_bytes([row[2 * i], row[2 * i + 1]])),
        BitDepth::Eight => f64::from(row[i]),
        BitDepth::One | BitDepth::Two | BitDepth::Four => {
            let shift = 8 - bits - i * bits % 8;
            f64::from(row[i * bits / 8] >> shift & ((1 << bits) - 1) as u8)
        }
    };
    let mut values = Vec::with_capacity(width * height);
    for row in data.chunks_exact(row_bytes).take(height) {
        for x in 0..width {
            let unknown = channels == 2 && value(row, 2 * x + 1) == 0.0;
            values.push(if unknown { f64::NAN } else { value(row, channels * x) });
        }
    }
    Ok(Grid { columns: width, values, full: Some(((1_u32 << bits) - 1).into()) })
}
