//! How far two pictures are apart.

use crate::picture::Picture;

/// The differences between two pictures of one size, in steps of [`max`](Self::max).
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// What stands for full brightness: the greater of the two pictures'.
    pub max: u16,
    /// In pixels.
    pub width: usize,
    /// In pixels.
    pub height: usize,
    /// 3, or 4 if one of the pictures has alpha.
    pub channels: usize,
    /// How far apart each channel of each pixel is.
    differences: Vec<u16>,
    /// How many channels are 0, 1, 2, … apart.
    histogram: Vec<u64>,
}

/// Pictures of different sizes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}x{} against {}x{} pixels", a.0, a.1, b.0, b.1)]
pub struct SizesDiffer {
    /// Of one.
    pub a: (usize, usize),
    /// Of the other.
    pub b: (usize, usize),
}

impl Comparison {
    /// Compares channel by channel. Samples are first scaled to the greater maximum and rounded; a
    /// picture without alpha is opaque.
    ///
    /// # Errors
    ///
    /// Where the sizes differ.
    pub fn new(a: &Picture, b: &Picture) -> Result<Self, SizesDiffer> {
        if (a.width, a.height) != (b.width, b.height) {
            return Err(SizesDiffer {
                a: (a.width, a.height),
                b: (b.width, b.height),
            });
        }
        let max = a.max.max(b.max);
        let channels = a.channels.max(b.channels);
        let mut differences = Vec::with_capacity(a.width * a.height * channels);
        let mut histogram = vec![0; usize::from(max) + 1];
        let pixels_of_b = b.samples.chunks_exact(b.channels);
        for (of_a, of_b) in a.samples.chunks_exact(a.channels).zip(pixels_of_b) {
            for channel in 0..channels {
                let sample = |pixel: &[u16], own: u16| match pixel.get(channel) {
                    Some(&sample) => scaled(sample, own, max),
                    None => max,
                };
                let difference = sample(of_a, a.max).abs_diff(sample(of_b, b.max));
                histogram[usize::from(difference)] += 1;
                differences.push(difference);
            }
        }
        Ok(Self {
            max,
            width: a.width,
            height: a.height,
            channels,
            differences,
            histogram,
        })
    }

    /// The largest difference of a channel.
    pub fn largest(&self) -> u16 {
        self.histogram.iter().rposition(|&it| it > 0).unwrap_or(0) as u16
    }

    /// Peak signal-to-noise ratio over all channels, in dB; infinite for equal pictures.
    pub fn psnr(&self) -> f64 {
        let squares = self.histogram.iter().enumerate();
        let sum: f64 = squares.map(|(it, &n)| (it * it) as f64 * n as f64).sum();
        let mean = sum / self.differences.len() as f64;
        10.0 * (f64::from(self.max).powi(2) / mean).log10()
    }

    /// How many channels there are in all pixels.
    pub fn all_channels(&self) -> usize {
        self.differences.len()
    }

    /// How many channels are further apart than this.
    pub fn channels_beyond(&self, difference: u16) -> u64 {
        self.histogram[usize::from(self.max.min(difference)) + 1..]
            .iter()
            .sum()
    }

    /// How many pixels there are.
    pub fn all_pixels(&self) -> usize {
        self.width * self.height
    }

    /// How many pixels have a channel that is further apart than this.
    pub fn pixels_beyond(&self, difference: u16) -> usize {
        let pixels = self.differences.chunks_exact(self.channels);
        pixels
            .filter(|it| it.iter().any(|&channel| channel > difference))
            .count()
    }

    /// The differences as 8-bit red, green and blue, the largest of all as 255. A difference in alpha
    /// shows in all three.
    pub fn picture(&self) -> Vec<u8> {
        let largest = self.largest().max(1);
        let pixels = self.differences.chunks_exact(self.channels);
        pixels
            .flat_map(|pixel| {
                let alpha = pixel.get(3).copied().unwrap_or(0);
                [pixel[0], pixel[1], pixel[2]].map(|it| scaled(it.max(alpha), largest, 255) as u8)
            })
            .collect()
    }
}

/// A sample out of `from` as one out of `to`, rounded to the nearest, halves up.
fn scaled(sample: u16, from: u16, to: u16) -> u16 {
    let (sample, from, to) = (u64::from(sample), u64::from(from), u64::from(to));
    ((2 * sample * to + from) / (2 * from)) as u16
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(max: u16, channels: usize, samples: &[u16]) -> Picture {
        Picture {
            width: samples.len() / channels,
            height: 1,
            channels,
            max,
            samples: samples.to_vec(),
        }
    }

    #[test]
    fn equal_pictures_are_not_apart() {
        let a = picture(255, 3, &[1, 2, 3, 4, 5, 6]);
        let comparison = Comparison::new(&a, &a).unwrap();
        assert_eq!(
            (comparison.largest(), comparison.psnr()),
            (0, f64::INFINITY)
        );
        assert_eq!(
            (comparison.pixels_beyond(0), comparison.channels_beyond(0)),
            (0, 0)
        );
        assert_eq!(comparison.picture(), [0; 6]);
    }

    #[test]
    fn differences_are_counted() {
        let a = picture(255, 3, &[0, 0, 0, 9, 9, 9, 7, 7, 7]);
        let b = picture(255, 3, &[0, 1, 2, 9, 9, 9, 7, 4, 7]);
        let comparison = Comparison::new(&a, &b).unwrap();
        assert_eq!(comparison.largest(), 3);
        let beyond = [0, 1, 2, 3, 65535]
            .map(|it| (comparison.channels_beyond(it), comparison.pixels_beyond(it)));
        assert_eq!(beyond, [(3, 2), (2, 2), (1, 1), (0, 0), (0, 0)]);
        assert_eq!((comparison.all_channels(), comparison.all_pixels()), (9, 3));
        // (1 + 4 + 9) / 9 mean square, 255² peak: 10·log10(65025·9/14).
        assert!(
            (comparison.psnr() - 46.212).abs() < 0.001,
            "{}",
            comparison.psnr()
        );
        assert_eq!(comparison.picture(), [0, 85, 170, 0, 0, 0, 0, 255, 0]);
    }

    #[test]
    fn the_lower_maximum_is_scaled_to_the_higher() {
        let narrow = picture(255, 3, &[0, 128, 255]);
        let wide = picture(65535, 3, &[0, 128 * 257, 65535]);
        let comparison = Comparison::new(&narrow, &wide).unwrap();
        assert_eq!((comparison.max, comparison.largest()), (65535, 0));
        let odd = picture(100, 3, &[0, 50, 100]);
        // 50 of 100 is 127.5, and so 128, of 255.
        assert_eq!(Comparison::new(&odd, &narrow).unwrap().largest(), 0);
    }

    #[test]
    fn alpha_is_a_channel_and_opaque_where_missing() {
        let opaque = picture(255, 3, &[1, 2, 3]);
        let comparison = Comparison::new(&picture(255, 4, &[1, 2, 3, 255]), &opaque).unwrap();
        assert_eq!((comparison.channels, comparison.largest()), (4, 0));
        let comparison = Comparison::new(&opaque, &picture(255, 4, &[1, 2, 3, 250])).unwrap();
        assert_eq!(
            (comparison.largest(), comparison.picture()),
            (5, vec![255; 3])
        );
    }

    #[test]
    fn sizes_must_agree() {
        let error = Comparison::new(&picture(255, 3, &[0; 3]), &picture(255, 3, &[0; 6]));
        assert_eq!(error.unwrap_err().to_string(), "1x1 against 2x1 pixels");
    }
}
