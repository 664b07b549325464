//! An observer that writes a picture of each stage.

use super::{drawing_overlay, field_overlay, graph_overlay, ink_picture, streamlines_overlay, to_png};
use crate::clean::LineImage;
use crate::drawing::Drawing;
use crate::error::{Error, Result};
use crate::field::PolyVectorField;
use crate::graph::StrokeGraph;
use crate::hooks::Observer;
use crate::load::Scan;
use crate::streamline::Streamline;
use crate::write::write_file;
use image::ImageFormat;
use std::io::Cursor;
use std::path::{Path, PathBuf};

/// Writes `1-ink.png` and, each as `.svg` and `.png`, `2-field`, `3-streamlines`, `4-graph` and
/// `5-strokes` to a folder as a trace goes on. Changes nothing.
#[derive(Debug)]
pub struct DebugDir<'a> {
    folder: PathBuf,
    scan: &'a Scan,
    streamlines: Vec<Streamline>,
}

impl<'a> DebugDir<'a> {
    /// Pictures over `scan`, the one that will be traced; the folder is made where it does not exist.
    ///
    /// # Errors
    /// [`Error::Write`] when the folder cannot be made.
    pub fn create(folder: &Path, scan: &'a Scan) -> Result<Self> {
        std::fs::create_dir_all(folder).map_err(|cause| Error::Write { path: folder.to_owned(), cause })?;
        Ok(Self { folder: folder.to_owned(), scan, streamlines: Vec::new() })
    }

    fn write(&self, name: &str, svg: &str) -> Result<()> {
        write_file(&self.folder.join(format!("{name}.svg")), svg.as_bytes())?;
        write_file(&self.folder.join(format!("{name}.png")), &to_png(svg)?)
    }
}

impl Observer for DebugDir<'_> {
    fn on_line_image(&mut self, image: &mut LineImage) -> Result<()> {
        let mut png = Cursor::new(Vec::new());
        let path = self.folder.join("1-ink.png");
        let encoded = ink_picture(image).write_to(&mut png, ImageFormat::Png);
        encoded.map_err(|e| Error::Write { path: path.clone(), cause: std::io::Error::other(e) })?;
        write_file(&path, &png.into_inner())
    }

    fn on_field(&mut self, _image: &LineImage, field: &mut PolyVectorField) -> Result<()> {
        self.write("2-field", &field_overlay(self.scan, field))
    }

    fn on_streamline(&mut self, image: &LineImage, streamline: &mut Streamline) -> Result<bool> {
        let mut in_scan = streamline.clone();
        in_scan.points.iter_mut().for_each(|p| *p = (p.to_vec2() / image.scale).to_point());
        self.streamlines.push(in_scan);
        Ok(true)
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
