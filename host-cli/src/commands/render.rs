//! `whitted render`.

use std::io::{self, Write};
use std::num::NonZeroUsize;
use std::ops::Range;
use std::path::Path;
use std::time::{Duration, Instant};

use anyhow::{Context, bail};
use indicatif::{ProgressBar, ProgressStyle};
use whitted::{Counters, Vec3, View};

use super::Outcome;
use crate::args;
use crate::map::HostMap;
use crate::output::Output;
use crate::picture::{Format, Transfer, Writer};
use crate::render::{Sampling, Settings, encode, render_sampled};
use crate::scene::{HostScene, Pool};
use crate::scene_file::map::{self, MapFile};
use crate::scene_file::{self, SceneFile};

/// The scene that is rendered when none is named.
const BUILTIN: &str = include_str!("../../scenes/builtin.toml");

/// Of pictures of scenes that ask for none.
pub(super) const DEFAULT_SIZE: [u32; 2] = [512, 512];

pub(super) fn run(args: &args::Render) -> anyhow::Result<Outcome> {
    let format = match (Format::of(&args.output)?, args.ascii) {
        (Format::Ppm, true) => Format::PlainPpm,
        (Format::Png, true) => bail!("--ascii is for PPM; {} is a PNG", args.output.display()),
        (format, _) => format,
    };
    let transfer = if args.srgb {
        Transfer::Srgb
    } else {
        Transfer::Linear
    };
    let job = Job {
        args,
        format,
        transfer,
    };
    match &args.scene {
        Some(path) if map::is_map(path) => job.map(&map::read(path)?)?,
        Some(path) => job.scene(&scene_file::read(path)?)?,
        None => job.scene(&builtin()?)?,
    }
    Ok(Outcome::Success)
}

/// How a picture is to be written.
struct Job<'a> {
    args: &'a args::Render,
    format: Format,
    transfer: Transfer,
}

/// A pixel of a picture in a file: red, green, blue.
type Pixel = [u8; 3];

/// Makes pixels of a file of what rays bring, on any thread.
type Develop<'a> = &'a (dyn Fn(&[Vec3], &mut [Pixel]) + Sync);

/// Where a picture goes, some whole rows at a time.
type Emit<'a> = &'a mut dyn FnMut(&[Pixel]) -> io::Result<()>;

impl Job<'_> {
    fn scene(&self, file: &SceneFile) -> anyhow::Result<()> {
        let pool = Pool::new(file);
        let scene = HostScene::new(file, &pool)?;
        let [width, height] = self.size(file.size);
        let rows = self.rows(height)?;
        let Some(view) = scene.camera(width, height)? else {
            bail!("{}: the scene has no camera", file.path.display());
        };
        let settings = self.settings(file.depth);
        let sampling = self.sampling()?;
        self.write(&view, rows.clone(), |develop, emit| {
            let counters = render_sampled(&scene, &view, rows, settings, sampling, develop, emit)?;
            Ok(Some(counters))
        })
    }

    /// How pixels are sampled.
    fn sampling(&self) -> anyhow::Result<Sampling> {
        match (self.args.adaptive, self.args.samples) {
            (None, samples) => Ok(samples.map_or(Sampling::Middle, Sampling::Regular)),
            (Some(bound), samples) => match samples.unwrap_or(4) {
                samples @ (2 | 4 | 8 | 16) => Ok(Sampling::Adaptive {
                    bound,
                    levels: samples.ilog2(),
                }),
                samples => bail!("--samples is {samples}: with --adaptive it is 2, 4, 8 or 16"),
            },
        }
    }

    fn map(&self, file: &MapFile) -> anyhow::Result<()> {
        let host = HostMap::new(file);
        let [width, height] = self.size(file.size);
        let rows = self.rows(height)?;
        let view = host.view(width, height)?;
        let sampling = self.sampling()?;
        if self.args.trace {
            let settings = self.settings(file.depth);
            return self.write(&view, rows.clone(), |develop, emit| {
                let counters = host.trace(&view, rows, settings, sampling, develop, emit)?;
                Ok(Some(counters))
            });
        }
        if self.args.depth.is_some() || self.args.threshold > 0.0 {
            bail!("--depth and --threshold are for traced pictures; for a map, add --trace");
        }
        let samples = match sampling {
            Sampling::Middle => 1,
            Sampling::Regular(samples) => samples,
            Sampling::Adaptive { .. } => {
                bail!("--adaptive saves rays, and columns take one each; for a map, add --trace")
            }
        };
        self.write(&view, rows.clone(), |develop, emit| {
            host.draw(&view, rows, samples, develop, emit)?;
            Ok(None)
        })
    }

    /// Of the picture.
    fn size(&self, size: Option<[u32; 2]>) -> [u32; 2] {
        match self.args.size {
            Some(size) => [size.width, size.height],
            None => size.unwrap_or(DEFAULT_SIZE),
        }
    }

    /// Those that are asked for.
    fn rows(&self, height: u32) -> anyhow::Result<Range<u32>> {
        let rows = self.args.rows.as_ref().map_or(0..height, |it| it.0.clone());
        if rows.end > height {
            let end = rows.end;
            bail!("--rows ends at {end}, but the picture has {height} rows");
        }
        Ok(rows)
    }

    fn settings(&self, depth: usize) -> Settings {
        Settings {
            depth: self.args.depth.unwrap_or(depth),
            threshold: self.args.threshold,
        }
    }

    /// Writes the rows that `draw` makes.
    fn write(
        &self,
        view: &View,
        rows: Range<u32>,
        draw: impl FnOnce(Develop<'_>, Emit<'_>) -> io::Result<Option<Counters>> + Send,
    ) -> anyhow::Result<()> {
        let (args, transfer) = (self.args, self.transfer);
        let cannot_write = || format!("cannot write {}", args.output.display());
        let output = Output::create(&args.output).with_context(cannot_write)?;
        let height = rows.end - rows.start;
        let sink = output.sink().with_context(cannot_write)?;
        let writer = Writer::new(sink, self.format, view.width, height, transfer);
        let mut writer = writer.with_context(cannot_write)?;
        let progress = progress_bar(u64::from(height) * u64::from(view.width));
        let develop = |pixels: &[Vec3], developed: &mut [Pixel]| {
            encode(pixels, developed, transfer);
            progress.inc(pixels.len() as u64);
        };
        let start = Instant::now();
        let counters = with_threads(args.threads, || {
            draw(&develop, &mut |pixels| writer.rows(pixels.as_flattened()))
        })?
        .with_context(cannot_write)?;
        let time = start.elapsed();
        progress.finish_and_clear();
        writer.finish().with_context(cannot_write)?;
        output.commit().with_context(cannot_write)?;
        let summary = match counters {
            Some(counters) => summary(view, height, time, &counters),
            None => {
                let (width, seconds) = (view.width, time.as_secs_f64());
                format!("{width}x{height} in {seconds:.3} s by columns")
            }
        };
        // Standard error may be closed; the picture is complete all the same.
        let _ = writeln!(io::stderr(), "{summary}");
        Ok(())
    }
}

fn builtin() -> Result<SceneFile, scene_file::SceneError> {
    scene_file::toml::parse(Path::new("builtin.toml"), BUILTIN)
}

/// Runs `work` with a number of threads, by default one a processor.
fn with_threads<T: Send>(
    threads: Option<NonZeroUsize>,
    work: impl FnOnce() -> T + Send,
) -> anyhow::Result<T> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads.map_or(0, NonZeroUsize::get))
        .build()
        .context("cannot start threads")?;
    Ok(pool.install(work))
}

/// Shows nothing unless standard error is a terminal.
fn progress_bar(pixels: u64) -> ProgressBar {
    let style = ProgressStyle::with_template("{wide_bar} {percent:>3} %, {eta} left")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::new(pixels).with_style(style)
}

fn summary(view: &View, rows: u32, time: Duration, counters: &Counters) -> String {
    let Counters {
        primary,
        reflected,
        refracted,
        shadow,
        hits,
    } = *counters;
    let seconds = time.as_secs_f64();
    let million_rays = (primary + reflected + refracted + shadow) as f64 / 1e6;
    format!(
        "{}x{rows} in {seconds:.3} s: {primary} primary, {reflected} reflected, {refracted} \
         refracted and {shadow} shadow rays, {hits} hits; {:.3} million rays/s",
        view.width,
        million_rays / seconds.max(1e-9),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_builtin_scene_shows_everything() {
        let file = builtin().unwrap();
        let pool = Pool::new(&file);
        let scene = HostScene::new(&file, &pool).unwrap();
        assert!(scene.camera(4, 3).unwrap().is_some());
        let mut kinds: Vec<_> = file.objects.iter().map(|it| it.shape.name()).collect();
        kinds.sort_unstable();
        kinds.dedup();
        assert_eq!(
            kinds,
            [
                "box", "frustum", "patch", "plane", "polygon", "sphere", "triangle"
            ]
        );
        assert!(file.materials.iter().any(|it| it.reflectance > 0.0));
        assert!(file.materials.iter().any(|it| it.transmittance > 0.0));
        assert!(file.lights.iter().any(|it| it.shadows));
    }
}
