//! Animated PNG (APNG): a movie that needs no other program.

use png::{BitDepth, ColorType, Compression, Encoder};

use super::{Image, LARGEST, PictureError};

/// Pictures of one size, shown one after the other without end, as the bytes of a file.
///
/// - `size`: width and height [pixels]; `rate`: pictures per second
/// - `draw`: draws a picture by its number, from 0 to `count`
///
/// # Errors
/// What `draw` says; [`PictureError::Size`] for a size out of range, or a picture of another one;
/// [`PictureError::Encoding`], also where there is no picture.
pub fn animation<E: From<PictureError>>(
    size: [usize; 2],
    count: usize,
    rate: u16,
    mut draw: impl FnMut(usize) -> Result<Image, E>,
) -> Result<Vec<u8>, E> {
    let [width, height] = size;
    let in_range = |size: usize| (1..=LARGEST).contains(&size);
    if !in_range(width) || !in_range(height) {
        return Err(PictureError::Size { width, height }.into());
    }
    let encoding = |error: png::EncodingError| E::from(PictureError::Encoding(error));
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, width as u32, height as u32);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::Balanced);
    encoder.set_animated(count as u32, 0).map_err(encoding)?;
    encoder.set_frame_delay(1, rate.max(1)).map_err(encoding)?;
    let mut writer = encoder.write_header().map_err(encoding)?;
    for index in 0..count {
        let image = draw(index)?;
        if [image.width, image.height] != size {
            return Err(PictureError::Size { width: image.width, height: image.height }.into());
        }
        writer.write_image_data(&image.rgb).map_err(encoding)?;
    }
    writer.finish().map_err(encoding)?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(width: usize, height: usize, shade: u8) -> Image {
        Image { width, height, rgb: vec![shade; 3 * width * height] }
    }

    #[test]
    fn every_picture_is_a_frame_of_the_file() {
        let shades = [0, 100, 200];
        let draw = |index: usize| Ok::<_, PictureError>(plain(8, 6, shades[index]));
        let bytes = animation([8, 6], 3, 10, draw).unwrap();
        let decoder = png::Decoder::new(std::io::Cursor::new(&bytes));
        let mut reader = decoder.read_info().unwrap();
        assert_eq!(reader.info().animation_control.unwrap().num_frames, 3);
        for shade in shades {
            let mut frame = vec![1; 8 * 6 * 3];
            reader.next_frame(&mut frame).unwrap();
            assert!(frame.iter().all(|&byte| byte == shade), "{shade}");
        }
    }

    #[test]
    fn another_size_is_refused() {
        let draw = |_: usize| Ok::<_, PictureError>(plain(6, 8, 0));
        assert!(matches!(animation([8, 6], 1, 10, draw), Err(PictureError::Size { width: 6, .. })));
        assert!(matches!(animation([0, 6], 1, 10, draw), Err(PictureError::Size { width: 0, .. })));
    }
}
