//! The command line's options; their names are those of the library's `Options`.

mod batch;
mod input;
mod network;
mod output;
mod strokes;

pub(crate) use batch::BatchArgs;
pub(crate) use input::LoadArgs;
#[cfg(feature = "train")]
pub(crate) use network::DeviceArgs;
pub(crate) use network::{DEFAULT_ESTIMATOR, Estimator, FieldSourceArgs, NetworkArgs};
pub(crate) use output::OutputArgs;
pub(crate) use strokes::{CleanArgs, FitArgs, options};

use clap::builder::styling::{AnsiColor, Styles};
use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  trace scan.png                          writes scan.svg
  trace scan.jpg -o drawing.dxf           names the output, and by that its kind
  trace - -o - < scan.tif > out.svg       reads standard input, writes standard output
  trace plan.tif --preset plan --dpi 300  a plan, sized in millimetres
  trace sketch.png --debug-dir look       also writes a picture of each stage to look/
  trace *.png                             each beside its input
  trace scans -r -o drawings              every drawing of a folder and the folders in it
  trace '2024-*/*.tif' -o drawings        every drawing that matches
  trace scan.png -o graph.json            the stroke graph, to be looked at or corrected
  trace graph.json -o out.svg             the strokes of a graph
  trace ink photo.jpg -o ink.png          what is taken for ink
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
    arg_required_else_help = true,
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
    /// Write what the network takes for ink.
    Ink(InkArgs),
    /// Compare traces with the strokes that were drawn.
    Eval(Box<EvalArgs>),
    /// Train the network that predicts the field, or the one that sees ink.
    #[cfg(feature = "train")]
    Train(TrainArgs),
    /// Not built in.
    #[cfg(not(feature = "train"))]
    #[command(hide = true)]
    Train(NoTraining),
    /// Trace many drawings into a folder; the same as more than one IN
    Batch(Box<TraceArgs>),
    /// Write what a shell needs to complete the command.
    Completions {
        /// The shell
        shell: clap_complete::Shell,
    },
    /// Write the manual page.
    Man,
}

/// What is said where training is asked for and not built in.
#[cfg(not(feature = "train"))]
pub(crate) const NO_TRAINING: &str =
    "train: this program was built without training; `cargo install fieldtrace --features train` builds one with it";

/// Whatever was asked of the training that is not built in.
#[cfg(not(feature = "train"))]
#[derive(Debug, Args)]
pub(crate) struct NoTraining {
    #[arg(trailing_var_arg = true, allow_hyphen_values = true, hide = true)]
    rest: Vec<std::ffi::OsString>,
}

/// The arguments of a trace.
#[derive(Debug, Args)]
pub(crate) struct TraceArgs {
    /// The drawing: PNG, JPEG, TIFF, PDF, SVG, WebP, BMP, GIF, PNM, TGA, QOI, JPEG XL or JPEG 2000, or
    /// a stroke graph in JSON; `-` is standard input. Several, a folder or a pattern make a batch
    #[arg(value_name = "IN", required_unless_present = "manifest")]
    pub(crate) inputs: Vec<PathBuf>,
    /// The file to write, its kind by the extension, or the folder for a batch; `-` is standard output
    /// [default: IN with the extension of the format, or - for standard input]
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
    #[command(flatten)]
    pub(crate) out: OutputArgs,
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
    /// Overwrite the output where there is a file already
    #[arg(long)]
    pub(crate) force: bool,
    #[command(flatten)]
    pub(crate) load: LoadArgs,
    #[command(flatten)]
    pub(crate) clean: CleanArgs,
    #[command(flatten)]
    pub(crate) source: FieldSourceArgs,
    #[command(flatten)]
    pub(crate) talk: TalkArgs,
}

/// The arguments of `trace ink`.
#[derive(Debug, Args)]
pub(crate) struct InkArgs {
    /// The page, or `-` for standard input
    #[arg(value_name = "IN")]
    pub(crate) input: PathBuf,
    /// The PNG to write, black where all of a pixel is ink; `-` is standard output
    #[arg(short, long, value_name = "OUT")]
    pub(crate) output: PathBuf,
    /// Overwrite the output where there is a file already
    #[arg(long)]
    pub(crate) force: bool,
    #[command(flatten)]
    pub(crate) load: LoadArgs,
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
    /// Also write report.md to a folder: the figures by family, and pictures of the worst traces over their truth
    #[arg(long, value_name = "DIR")]
    pub(crate) report: Option<PathBuf>,
    /// How many of the worst traces the report shows
    #[arg(long, value_name = "N", default_value_t = 5, requires = "report")]
    pub(crate) worst: usize,
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
    /// Mix in the pages of a folder where ink is trained: NAME.png with its ink, black on white, in NAME.ink.png or
    /// as the strokes and solids of NAME.svg
    #[arg(long, value_name = "DIR")]
    pub(crate) pages: Option<PathBuf>,
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
    /// Only draw the pages that ink is validated on, each over its truth, to pages.png in the folder
    #[arg(long)]
    pub(crate) show: bool,
    #[command(flatten)]
    pub(crate) device: DeviceArgs,
    #[command(flatten)]
    pub(crate) talk: TalkArgs,
}

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

fn parse_number(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|v: &f64| v.is_finite()).ok_or_else(|| "not a number".into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::{self, Options, StrokeWidth, Threshold};
    use clap::CommandFactory;

    fn parsed(words: &[&str]) -> Options {
        let cli = Cli::parse_from([&["trace", "in.png"], words].concat());
        super::options(&cli.trace.clean, Some(&cli.trace.fit))
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
