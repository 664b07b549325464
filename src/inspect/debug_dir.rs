//! An observer that writes a picture of each stage.

use super::{
    coverage_picture, drawing_overlay, field_overlay, graph_overlay, ink_picture, lines_overlay, streamlines_overlay,
    to_png,
};
use crate::clean::LineImage;
use crate::drawing::Drawing;
use crate::error::{Error, Result};
use crate::field::PolyVectorField;
use crate::graph::{Line, Pass, Ran, StrokeGraph, passes};
use crate::hooks::Observer;
use crate::load::Scan;
use crate::raster::Raster;
use crate::streamline::Streamline;
use crate::write::{write_file, write_png};
use std::path::{Path, PathBuf};

/// Writes, where an estimator told the ink, `0-coverage.png`, then `1-ink.png` and, each as `.svg` and `.png`, `2-field`, `3-streamlines`, `4-graph` and
/// `5-strokes` to a folder as a trace goes on, and for each pass of the graph that changed something `4-NUMBER-PASS`, with
/// `-broad` after it for the lines that are traced apart from the others. Changes nothing.
#[derive(Debug)]
pub struct DebugDir<'a> {
    folder: PathBuf,
    scan: &'a Scan,
    streamlines: Vec<Streamline>,
    /// The lines of the image that is traced now, before the next pass.
    lines: Vec<Line>,
    /// Whether broad lines are traced apart.
    has_broad: bool,
}

impl<'a> DebugDir<'a> {
    /// Pictures over `scan`, the one that will be traced; the folder is made where it does not exist.
    ///
    /// # Errors
    /// [`Error::Write`] when the folder cannot be made.
    pub fn create(folder: &Path, scan: &'a Scan) -> Result<Self> {
        std::fs::create_dir_all(folder).map_err(|cause| Error::Write { path: folder.to_owned(), cause })?;
        Ok(Self { folder: folder.to_owned(), scan, streamlines: Vec::new(), lines: Vec::new(), has_broad: false })
    }

    fn write(&self, name: &str, svg: &str) -> Result<()> {
        write_file(&self.folder.join(format!("{name}.svg")), svg.as_bytes())?;
        write_file(&self.folder.join(format!("{name}.png")), &to_png(svg)?)
    }

    fn write_pass(&self, image: &LineImage, pass: &Pass, svg: &str) -> Result<()> {
        let number = passes().position(|p| p.name == pass.name).map_or(0, |k| k + 1);
        let layer = if self.has_broad && image.broad.is_none() { "-broad" } else { "" };
        self.write(&format!("4-{number:02}-{}{layer}", pass.name.replace(' ', "-")), svg)
    }
}

impl Observer for DebugDir<'_> {
    fn on_ink(&mut self, _scan: &Scan, coverage: &mut Raster<f32>) -> Result<()> {
        write_png(&self.folder.join("0-coverage.png"), &coverage_picture(coverage))
    }

    fn on_line_image(&mut self, image: &mut LineImage) -> Result<()> {
        self.has_broad = image.broad.is_some();
        write_png(&self.folder.join("1-ink.png"), &ink_picture(image).into())
    }

    fn on_field(&mut self, _image: &LineImage, field: &mut PolyVectorField) -> Result<()> {
        self.lines.clear();
        self.write("2-field", &field_overlay(self.scan, field))
    }

    fn on_streamline(&mut self, image: &LineImage, streamline: &mut Streamline) -> Result<bool> {
        self.lines.push(Line::from(&*streamline));
        let mut in_scan = streamline.clone();
        in_scan.points.iter_mut().for_each(|p| *p = (p.to_vec2() / image.scale).to_point());
        self.streamlines.push(in_scan);
        Ok(true)
    }

    fn on_lines(&mut self, image: &LineImage, ran: &Ran, lines: &[Line]) -> Result<()> {
        let before = std::mem::replace(&mut self.lines, lines.to_vec());
        if ran.changes == 0 {
            return Ok(());
        }
        self.write_pass(image, ran.pass, &lines_overlay(self.scan, image.scale, &before, lines))
    }

    fn on_finish(&mut self, image: &LineImage, ran: &Ran, graph: &StrokeGraph) -> Result<()> {
        if ran.changes == 0 {
            return Ok(());
        }
        self.write_pass(image, ran.pass, &graph_overlay(self.scan, image.scale, graph))
    }

    fn on_graph(&mut self, image: &LineImage, graph: &mut StrokeGraph) -> Result<()> {
        let streamlines = std::mem::take(&mut self.streamlines);
        self.write("3-streamlines", &streamlines_overlay(self.scan, 1.0, &streamlines))?;
        self.write("4-graph", &graph_overlay(self.scan, image.scale, graph))
    }

    fn on_drawing(&mut self, drawing: &mut Drawing) -> Result<()> {
        self.write("5-strokes", &drawing_overlay(self.scan, drawing))
    }
}
