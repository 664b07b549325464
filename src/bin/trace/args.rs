//! The command line's options; their names are those of the library's `Options`.

use clap::builder::styling::{AnsiColor, Styles};
use clap::{Args, Parser, Subcommand, ValueEnum};
use fieldtrace::batch::Share;
use fieldtrace::load::LoadOptions;
use fieldtrace::options::{self, Dashing, Invert, Options, StrokeWidth, Threshold};
use std::path::PathBuf;
use std::time::Duration;

const EXAMPLES: &str = "\
Examples:
  trace scan.png                          writes scan.svg
  trace scan.jpg -o drawing.svg           names the output
  trace - -o - < scan.tif > out.svg       reads standard input, writes standard output
  trace plan.tif --preset plan --dpi 300  a plan, sized in millimetres
  trace sketch.png --debug-dir look       also writes a picture of each stage to look/
  trace scans -r -o drawings              every drawing of a folder and the folders in it
  trace '2024-*/*.tif' -o drawings        every drawing that matches
  trace scan.png -o graph.json            the stroke graph, to be looked at or corrected
  trace graph.json -o out.svg             the strokes of a graph
  trace field scan.png -o field.npz       the direction field alone
  trace eval drawings                     how good the traces of a folder of SVGs are

A file whose name is that of a subcommand is given as ./field.
Exit codes: 0 done, 1 a file could not be traced, 2 wrong usage, 130 interrupted.";

const STYLES: Styles = Styles::styled()
    .header(AnsiColor::Green.on_default().bold())
    .usage(AnsiColor::Green.on_default().bold())
    .literal(AnsiColor::Cyan.on_default().bold());

/// Turn a raster line drawing into few, smooth, editable centreline strokes.
#[derive(Debug, Parser)]
#[command(
    name = "trace",
    version,
    styles = STYLES,
    after_help = EXAMPLES,
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true,
    disable_help_subcommand = true,
    subcommand_help_heading = "Subcommands"
)]
pub(crate) struct Cli {
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
    #[command(flatten)]
    pub(crate) trace: TraceArgs,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Write the field of directions that strokes follow.
    Field(FieldArgs),
    /// Compare traces with the strokes that were drawn.
    Eval(EvalArgs),
    /// Train the network that predicts the field.
    #[cfg(feature = "train")]
    Train(TrainArgs),
    /// Trace many drawings into a folder; the same as more than one IN
    Batch(Box<TraceArgs>),
}

/// The arguments of a trace.
#[derive(Debug, Args)]
pub(crate) struct TraceArgs {
    /// The drawing: PNG, JPEG, TIFF, WebP, BMP, GIF, PNM or SVG, or a stroke graph in JSON; `-` is standard
    /// input. Several, a folder or a pattern make a batch
    #[arg(value_name = "IN", required_unless_present = "manifest")]
    pub(crate) inputs: Vec<PathBuf>,
    /// The SVG to write, the stroke graph where the name ends in .json, or the folder for a batch; `-` is
    /// standard output [default: IN with .svg, or - for standard input]
    #[arg(short, long, value_name = "OUT")]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) load: LoadArgs,
    #[command(flatten)]
    pub(crate) clean: CleanArgs,
    #[command(flatten)]
    pub(crate) fit: FitArgs,
    #[command(flatten)]
    pub(crate) source: FieldSourceArgs,
    /// Decimals of the coordinates and widths in the output
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = parse_precision, help_heading = "Output")]
    pub(crate) precision: usize,
    /// Also write the stroke graph, as JSON that can be corrected and traced on
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub(crate) graph: Option<PathBuf>,
    /// Also write a picture of each stage, laid over the input, to this folder
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    pub(crate) debug_dir: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) talk: TalkArgs,
    #[command(flatten)]
    pub(crate) batch: BatchArgs,
}

/// The arguments of `trace field`.
#[derive(Debug, Args)]
pub(crate) struct FieldArgs {
    /// The drawing, or `-` for standard input
    #[arg(value_name = "IN")]
    pub(crate) input: PathBuf,
    /// Where to: .npz for complex64 arrays c0 and c2 and a uint8 mask, each [height, width] of the
    /// input; .png or .svg for a picture
    #[arg(short, long, value_name = "OUT")]
    pub(crate) output: PathBuf,
    #[command(flatten)]
    pub(crate) load: LoadArgs,
    #[command(flatten)]
    pub(crate) clean: CleanArgs,
    #[command(flatten)]
    pub(crate) source: FieldSourceArgs,
    #[command(flatten)]
    pub(crate) talk: TalkArgs,
}

/// The arguments of `trace eval`.
#[derive(Debug, Args)]
pub(crate) struct EvalArgs {
    /// Folders or files: SVGs with the true strokes, and the rasters to trace beside them. The truth of NAME.png and of
    /// NAME.KIND.png is NAME.gt.svg or NAME.svg; an SVG without a raster is rendered
    #[arg(value_name = "IN", required = true)]
    pub(crate) inputs: Vec<PathBuf>,
    /// Trace only the rasters NAME.KIND.png and the like; `render` renders the SVGs instead
    #[arg(long, value_name = "KIND", value_delimiter = ',')]
    pub(crate) kind: Vec<String>,
    /// What gives the directions; several are compared
    #[arg(long, value_name = "KIND", value_delimiter = ',', default_value = DEFAULT_ESTIMATOR)]
    pub(crate) estimators: Vec<Estimator>,
    /// Also a row for each drawing
    #[arg(long)]
    pub(crate) files: bool,
    /// Also write all figures to a file; `-` is standard output, in place of the table
    #[arg(long, value_name = "FILE")]
    pub(crate) json: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) load: LoadArgs,
    #[command(flatten)]
    pub(crate) clean: CleanArgs,
    #[command(flatten)]
    pub(crate) fit: FitArgs,
    #[command(flatten)]
    pub(crate) network: NetworkArgs,
    /// No warnings
    #[arg(short, long, help_heading = "Messages")]
    pub(crate) quiet: bool,
}

/// The arguments of `trace train`.
#[cfg(feature = "train")]
#[derive(Debug, Args)]
pub(crate) struct TrainArgs {
    /// A TOML file with what the run is to be; everything has a default
    #[arg(value_name = "CONFIG")]
    pub(crate) config: Option<PathBuf>,
    /// The folder of the run: weights, checkpoint, metrics.csv, curves.svg
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: PathBuf,
    /// Go on from the checkpoint in the run's folder, exactly as if it had never stopped
    #[arg(long, conflicts_with = "from")]
    pub(crate) resume: bool,
    /// Start from the weights in a file, or from `built-in`
    #[arg(long, value_name = "WEIGHTS")]
    pub(crate) from: Option<PathBuf>,
    /// Mix in the strokes of the SVGs in a folder
    #[arg(long, value_name = "DIR")]
    pub(crate) svgs: Option<PathBuf>,
    /// Steps in all
    #[arg(long, value_name = "N")]
    pub(crate) steps: Option<usize>,
    /// Crops in a step
    #[arg(long, value_name = "N")]
    pub(crate) batch: Option<usize>,
    /// Largest learning rate
    #[arg(long, value_name = "R")]
    pub(crate) rate: Option<f64>,
    /// Stop after this many validations without a better one; 0 never does
    #[arg(long, value_name = "N")]
    pub(crate) patience: Option<usize>,
    /// Seed of the weights and of all data
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u64>,
    #[command(flatten)]
    pub(crate) device: DeviceArgs,
    #[command(flatten)]
    pub(crate) talk: TalkArgs,
}

/// Where the network runs.
#[derive(Debug, Args)]
#[command(next_help_heading = "Network")]
pub(crate) struct DeviceArgs {
    /// What runs the network: `cpu` is the program's own engine, the fastest on the CPU; `flex`, `ndarray` and `gpu`
    /// are backends of the tensor library, which have to be built in
    #[arg(long, value_name = "DEVICE", default_value = "auto",
          value_parser = ["auto", "cpu", "flex", "ndarray", "gpu"])]
    pub(crate) device: String,
}

/// Where the field comes from.
#[derive(Debug, Args)]
#[command(next_help_heading = "Network")]
pub(crate) struct FieldSourceArgs {
    /// What gives the directions: the trained network, or the structure tensor of the ink
    #[arg(long, value_name = "KIND", default_value = DEFAULT_ESTIMATOR)]
    pub(crate) estimator: Estimator,
    #[command(flatten)]
    pub(crate) network: NetworkArgs,
}

/// Which network, and where it runs.
#[derive(Debug, Args)]
#[command(next_help_heading = "Network")]
pub(crate) struct NetworkArgs {
    /// Weights of the network, in place of those that the program carries
    #[arg(long, value_name = "FILE")]
    pub(crate) weights: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) device: DeviceArgs,
}

const DEFAULT_ESTIMATOR: &str = "unet";

/// A source of fields.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Estimator {
    /// The trained network
    Unet,
    /// The fourth-order structure tensor
    Tensor,
}

/// How the input is read.
#[derive(Debug, Args)]
#[command(next_help_heading = "Input")]
pub(crate) struct LoadArgs {
    /// Dots per inch, in place of what the input says; sizes the output in millimetres, and an SVG
    /// input's rendering in pixels
    #[arg(long, value_name = "DPI", value_parser = parse_dpi, allow_negative_numbers = true)]
    dpi: Option<f64>,
    /// Pixels along the longer side of an SVG input's rendering
    #[arg(long, value_name = "PX", value_parser = clap::value_parser!(u32).range(1..=65535))]
    size: Option<u32>,
    /// Refuse inputs of more pixels than this
    #[arg(long, value_name = "N", default_value_t = LoadOptions::default().max_pixels,
          value_parser = clap::value_parser!(u64).range(1..))]
    max_pixels: u64,
}

impl LoadArgs {
    /// The library's form.
    pub(crate) fn options(&self) -> LoadOptions {
        LoadOptions { max_pixels: self.max_pixels, dpi: self.dpi, size: self.size }
    }
}

/// How ink is told from paper.
#[derive(Debug, Args)]
#[command(next_help_heading = "Ink")]
pub(crate) struct CleanArgs {
    /// Options that suit a kind of drawing; those given beside it override it
    #[arg(long, value_name = "KIND")]
    preset: Option<Preset>,
    /// Darkness from which a pixel is ink: `auto`, or between 0 (paper) and 1 (black) [default: auto]
    #[arg(long, value_name = "T", value_parser = parse_threshold, allow_negative_numbers = true)]
    threshold: Option<Threshold>,
    /// Whether the lines are lighter than the ground [default: auto]
    #[arg(long, value_name = "WHEN", value_parser = parse_invert)]
    invert: Option<Invert>,
    /// Remove specks of at most this many pixels [default: decided from the image]
    #[arg(long, value_name = "N")]
    despeckle: Option<usize>,
}

/// How strokes are made.
#[derive(Debug, Args)]
#[command(next_help_heading = "Strokes")]
pub(crate) struct FitArgs {
    /// How far a curve may leave the ink's centre, in line widths: less follows closer, with more
    /// pieces [default: 0.1]
    #[arg(long, value_name = "W", value_parser = parse_number, allow_negative_numbers = true)]
    detail: Option<f64>,
    /// Drop strokes shorter than this many line widths, unless they are dots [default: 0.5]
    #[arg(long, value_name = "W", value_parser = parse_number, allow_negative_numbers = true)]
    min_length: Option<f64>,
    /// Stroke widths: `measured` for each, `uniform` for the drawing's median, a number of pixels, or
    /// `outline` for filled outlines that keep the taper of each [default: measured]
    #[arg(long, value_name = "WIDTH", value_parser = parse_width, allow_negative_numbers = true)]
    width: Option<StrokeWidth>,
    /// Bridge breaks in a line of at most this many line widths, where direction and distance agree;
    /// `auto` does so for a pencil's on a scan [default: auto]
    #[arg(long, value_name = "W", value_parser = parse_gap, allow_negative_numbers = true)]
    gap: Option<Gap>,
    /// Dashes at even distances: `keep` each as a stroke, or `join` them into a dashed one [default: keep]
    #[arg(long, value_name = "WHAT", value_parser = parse_dashes)]
    dashes: Option<Dashing>,
}

/// Line widths of paper, or `None` for `auto`.
#[derive(Clone, Copy, Debug)]
struct Gap(Option<f64>);

/// What is said on standard error.
#[derive(Debug, Args)]
#[command(next_help_heading = "Messages")]
pub(crate) struct TalkArgs {
    /// No warnings
    #[arg(short, long, conflicts_with = "verbose")]
    pub(crate) quiet: bool,
    /// Seconds and counts of each stage
    #[arg(short, long)]
    pub(crate) verbose: bool,
}

/// How many drawings are traced in one go; any of these makes a batch.
#[derive(Debug, Args)]
#[command(next_help_heading = "Batch")]
pub(crate) struct BatchArgs {
    /// Also take the folders in a folder, and keep their tree
    #[arg(short, long)]
    pub(crate) recursive: bool,
    /// Read more inputs from a file, one a line; `-` is standard input
    #[arg(long, value_name = "FILE")]
    pub(crate) manifest: Option<PathBuf>,
    /// Take share I of N of the sorted inputs
    #[arg(long, value_name = "I/N")]
    pub(crate) shard: Option<Share>,
    /// Trace again what has an output that is newer than the input
    #[arg(long)]
    pub(crate) force: bool,
    /// Threads [default: one for each core]
    #[arg(short, long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) jobs: Option<u16>,
    /// Give up on a file after this time
    #[arg(long, value_name = "SECONDS", value_parser = parse_seconds, allow_negative_numbers = true)]
    pub(crate) timeout: Option<Duration>,
    /// Write a record for each file to standard output, as JSON lines in the order of the inputs
    #[arg(long)]
    pub(crate) json: bool,
}

impl BatchArgs {
    /// Whether any was given.
    pub(crate) fn any(&self) -> bool {
        let flags = self.recursive || self.force || self.json;
        flags || self.manifest.is_some() || self.shard.is_some() || self.jobs.is_some() || self.timeout.is_some()
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Preset {
    /// Pencil and ink: looser curves, short strokes dropped
    Sketch,
    /// Technical plans: a tight fit, small details kept
    Plan,
    /// Icons: a tight fit, one width for all strokes
    Icon,
}

/// The library's options: the preset's, overridden by those that were given.
pub(crate) fn options(clean: &CleanArgs, fit: Option<&FitArgs>) -> Options {
    let base = match clean.preset {
        None => Options::default(),
        Some(Preset::Sketch) => Options::preset(options::Preset::Sketch),
        Some(Preset::Plan) => Options::preset(options::Preset::Plan),
        Some(Preset::Icon) => Options::preset(options::Preset::Icon),
    };
    Options {
        detail: fit.and_then(|f| f.detail).unwrap_or(base.detail),
        min_length: fit.and_then(|f| f.min_length).unwrap_or(base.min_length),
        despeckle: clean.despeckle.or(base.despeckle),
        threshold: clean.threshold.unwrap_or(base.threshold),
        invert: clean.invert.unwrap_or(base.invert),
        width: fit.and_then(|f| f.width).unwrap_or(base.width),
        gap: fit.and_then(|f| f.gap).map_or(base.gap, |Gap(gap)| gap),
        dashes: fit.and_then(|f| f.dashes).unwrap_or(base.dashes),
    }
}

fn parse_number(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|v: &f64| v.is_finite()).ok_or_else(|| "not a number".into())
}

fn parse_dpi(text: &str) -> Result<f64, String> {
    let dpi = parse_number(text)?;
    if (1.0..=100_000.0).contains(&dpi) { Ok(dpi) } else { Err("not between 1 and 100000".into()) }
}

fn parse_seconds(text: &str) -> Result<Duration, String> {
    let seconds = parse_number(text)?;
    let time = Duration::try_from_secs_f64(seconds).ok().filter(|time| !time.is_zero());
    time.ok_or_else(|| "not a time in seconds".into())
}

fn parse_precision(text: &str) -> Result<usize, String> {
    text.parse().ok().filter(|n| *n <= 8).ok_or_else(|| "not a whole number between 0 and 8".into())
}

fn parse_threshold(text: &str) -> Result<Threshold, String> {
    match text {
        "auto" => Ok(Threshold::Auto),
        _ => parse_number(text).map(Threshold::Fixed).map_err(|_| "neither auto nor a number".into()),
    }
}

fn parse_invert(text: &str) -> Result<Invert, String> {
    match text {
        "auto" => Ok(Invert::Auto),
        "yes" => Ok(Invert::Yes),
        "no" => Ok(Invert::No),
        _ => Err("not one of auto, yes, no".into()),
    }
}

fn parse_gap(text: &str) -> Result<Gap, String> {
    match text {
        "auto" => Ok(Gap(None)),
        _ => parse_number(text).map(|w| Gap(Some(w))).map_err(|_| "neither auto nor a number".into()),
    }
}

fn parse_dashes(text: &str) -> Result<Dashing, String> {
    match text {
        "keep" => Ok(Dashing::Keep),
        "join" => Ok(Dashing::Join),
        _ => Err("not one of keep, join".into()),
    }
}

fn parse_width(text: &str) -> Result<StrokeWidth, String> {
    match text {
        "measured" => Ok(StrokeWidth::Measured),
        "uniform" => Ok(StrokeWidth::Uniform),
        "outline" => Ok(StrokeWidth::Outline),
        _ => parse_number(text)
            .map(StrokeWidth::Fixed)
            .map_err(|_| "neither measured, uniform, outline nor a number".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    fn parsed(words: &[&str]) -> Options {
        let cli = Cli::parse_from([&["trace", "in.png"], words].concat());
        options(&cli.trace.clean, Some(&cli.trace.fit))
    }

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn no_flag_gives_the_defaults() {
        assert_eq!(parsed(&[]), Options::default());
    }

    #[test]
    fn flags_override_a_preset() {
        assert_eq!(parsed(&["--preset", "icon"]), Options::preset(options::Preset::Icon));
        let overridden = parsed(&["--width", "2.5", "--preset", "icon", "--threshold", "0.4"]);
        let icon = Options::preset(options::Preset::Icon);
        assert_eq!(overridden, Options { width: StrokeWidth::Fixed(2.5), threshold: Threshold::Fixed(0.4), ..icon });
    }

    #[test]
    fn the_help_names_the_true_defaults() {
        let help = Cli::command().render_long_help().to_string();
        let default = Options::default();
        for value in [default.detail, default.min_length] {
            assert!(help.contains(&format!("[default: {value}]")), "{value}");
        }
    }

    #[test]
    fn a_subcommand_and_a_file_of_its_name_are_told_apart() {
        let field = Cli::parse_from(["trace", "field", "in.png", "-o", "f.npz"]);
        assert!(matches!(field.command, Some(Command::Field(_))));
        let file = Cli::parse_from(["trace", "./field"]);
        assert_eq!((file.command.is_none(), file.trace.inputs), (true, vec!["./field".into()]));
    }
}
