//! What a caller may see, change and refuse.

mod common;

use common::draw::{line, scan, sheet};
use fieldtrace::Error;
use fieldtrace::clean::LineImage;
use fieldtrace::drawing::{Color, Drawing};
use fieldtrace::estimate::{FieldEstimator, UNet};
use fieldtrace::field::PolyVectorField;
use fieldtrace::graph::StrokeGraph;
use fieldtrace::hooks::{Observer, veto};
use fieldtrace::load::Scan;
use fieldtrace::options::{Invert, Options, StrokeWidth, Threshold};
use fieldtrace::pipeline::Vectorizer;
use fieldtrace::streamline::Streamline;
use kurbo::Vec2;

/// A cross of two bars.
fn cross() -> Scan {
    scan(&sheet(80, 60, vec![line((8.0, 30.0), (72.0, 30.0), 4.0), line((40.0, 8.0), (40.0, 52.0), 4.0)]))
}

fn vectorizer() -> Vectorizer {
    Vectorizer::new(Options::default()).unwrap()
}

/// Writes down which stages it saw and refuses one of them.
#[derive(Default)]
struct Diary {
    seen: Vec<&'static str>,
    refuse: Option<&'static str>,
}

impl Diary {
    fn see(&mut self, stage: &'static str) -> fieldtrace::Result<()> {
        if self.seen.last() != Some(&stage) {
            self.seen.push(stage);
        }
        if self.refuse == Some(stage) { Err(veto(stage, "not today")) } else { Ok(()) }
    }
}

impl Observer for Diary {
    fn on_line_image(&mut self, _: &mut LineImage) -> fieldtrace::Result<()> {
        self.see("clean")
    }
    fn on_field(&mut self, image: &LineImage, field: &mut PolyVectorField) -> fieldtrace::Result<()> {
        assert_eq!(field.size(), image.ink.size());
        self.see("field")
    }
    fn on_streamline(&mut self, _: &LineImage, _: &mut Streamline) -> fieldtrace::Result<bool> {
        self.see("streamline").map(|()| true)
    }
    fn on_graph(&mut self, _: &LineImage, _: &mut StrokeGraph) -> fieldtrace::Result<()> {
        self.see("graph")
    }
    fn on_drawing(&mut self, _: &mut Drawing) -> fieldtrace::Result<()> {
        self.see("drawing")
    }
}

const STAGES: [&str; 5] = ["clean", "field", "streamline", "graph", "drawing"];

#[test]
fn every_stage_is_seen_in_order() {
    let mut diary = Diary::default();
    vectorizer().trace_observed(&cross(), &mut diary).unwrap();
    assert_eq!(diary.seen, STAGES);
}

#[test]
fn watching_changes_nothing() {
    let watched = vectorizer().trace_observed(&cross(), &mut Diary::default()).unwrap();
    assert_eq!(watched, vectorizer().trace(&cross()).unwrap());
}

#[test]
fn a_veto_stops_the_trace_at_its_stage() {
    for (i, stage) in STAGES.into_iter().enumerate() {
        let mut diary = Diary { refuse: Some(stage), ..Diary::default() };
        let error = vectorizer().trace_observed(&cross(), &mut diary).unwrap_err();
        assert!(matches!(&error, Error::Vetoed { stage: s, .. } if *s == stage), "{error}");
        assert!(error.to_string().contains("not today"));
        assert_eq!(diary.seen, STAGES[..=i]);
    }
}

/// Drops lines that run along an axis.
struct NoAxis(usize);

impl Observer for NoAxis {
    fn on_streamline(&mut self, _: &LineImage, s: &mut Streamline) -> fieldtrace::Result<bool> {
        let along = s.points[s.points.len() - 1] - s.points[0];
        Ok((along.x.abs() > along.y.abs()) == (self.0 == 0))
    }
}

#[test]
fn a_refused_streamline_is_no_stroke() {
    for axis in [0, 1] {
        let drawing = vectorizer().trace_observed(&cross(), &mut NoAxis(axis)).unwrap();
        assert_eq!(drawing.strokes.len(), 1, "{:?}", drawing.strokes);
        let along = drawing.strokes[0].centreline.end() - drawing.strokes[0].centreline.start();
        assert_eq!(along.x.abs() > along.y.abs(), axis == 0);
    }
}

/// Paints all strokes red.
struct Red;

impl Observer for Red {
    fn on_drawing(&mut self, drawing: &mut Drawing) -> fieldtrace::Result<()> {
        drawing.strokes.iter_mut().for_each(|s| s.color = Color([255, 0, 0]));
        Ok(())
    }
}

#[test]
fn a_changed_drawing_is_the_result() {
    let drawing = vectorizer().trace_observed(&cross(), &mut Red).unwrap();
    assert!(drawing.strokes.len() == 2 && drawing.strokes.iter().all(|s| s.color == Color([255, 0, 0])));
}

/// Fails, or gives a field of the wrong size.
struct Broken {
    fails: bool,
}

impl FieldEstimator for Broken {
    fn name(&self) -> &str {
        "broken"
    }
    fn estimate(&self, _: &LineImage) -> fieldtrace::Result<PolyVectorField> {
        if self.fails {
            return Err(Error::Estimate { estimator: self.name().into(), reason: "no weights".into() });
        }
        Ok(PolyVectorField::from_directions(3, 2, |_, _| None))
    }
}

#[test]
fn an_estimator_may_fail() {
    let error = vectorizer().with_estimator(Broken { fails: true }).trace(&cross()).unwrap_err();
    assert_eq!(error.to_string(), "the estimator broken failed: no weights");
}

#[test]
fn a_field_must_have_the_size_of_the_image() {
    let small = vectorizer().with_estimator(Broken { fails: false });
    assert!(matches!(small.trace(&cross()), Err(Error::FieldSize { field: (3, 2), image: (80, 60) })));
    assert!(matches!(small.field(&cross()), Err(Error::FieldSize { .. })));
    let field = PolyVectorField::from_directions(80, 59, |_, _| None);
    let result = vectorizer().trace_with_field(&cross(), &field, &mut ());
    assert!(matches!(result, Err(Error::FieldSize { field: (80, 59), image: (80, 60) })));
}

#[test]
fn the_field_of_a_scan_has_its_size_and_its_directions() {
    let field = vectorizer().field(&cross()).unwrap();
    assert_eq!(field.size(), (80, 60));
    let frame = fieldtrace::field::decode(field.c0()[(20, 30)], field.c2()[(20, 30)]).unwrap();
    assert!(frame.u.y.abs().min(frame.v.y.abs()) < 0.05, "{frame:?}");
    assert_eq!(field.confidence()[(20, 10)], 0.0);
}

#[test]
fn an_own_field_and_an_own_estimator_serve() {
    let by_estimator = vectorizer().with_estimator(UNet::built_in().unwrap()).trace(&cross()).unwrap();
    assert_eq!(by_estimator, vectorizer().trace(&cross()).unwrap());
    let field = PolyVectorField::from_directions(80, 60, |_, _| Some((Vec2::new(1.0, 0.0), Vec2::new(0.0, 1.0))));
    let by_field = vectorizer().trace_with_field(&cross(), &field, &mut ()).unwrap();
    assert_eq!(by_field.strokes.len(), 2, "{:?}", by_field.strokes);
}

#[test]
fn options_out_of_range_are_named() {
    let default = Options::default;
    let wrong = [
        ("detail", default().with(|o| o.detail = 0.0)),
        ("detail", default().with(|o| o.detail = f64::NAN)),
        ("min-length", default().with(|o| o.min_length = -1.0)),
        ("threshold", default().with(|o| o.threshold = Threshold::Fixed(1.0))),
        ("width", default().with(|o| o.width = StrokeWidth::Fixed(0.0))),
    ];
    for (name, options) in wrong {
        let error = Vectorizer::new(options).err().expect("an error");
        assert!(matches!(error, Error::Option { option, .. } if option == name), "{error}");
    }
}

#[test]
fn options_show_in_the_result() {
    let trace = |options| Vectorizer::new(options).unwrap().trace(&cross()).unwrap();
    let fixed = trace(Options::default().with(|o| o.width = StrokeWidth::Fixed(2.5)));
    assert!(fixed.strokes.len() == 2 && fixed.strokes.iter().all(|s| s.width == 2.5));
    assert!(trace(Options::default().with(|o| o.min_length = 100.0)).strokes.is_empty());
    let inverted = Scan { gray: cross().gray.map(|g| 1.0 - g), ..cross() };
    let vectorizer = Vectorizer::new(Options::default().with(|o| o.invert = Invert::Yes)).unwrap();
    assert_eq!(vectorizer.trace(&inverted).unwrap().strokes.len(), 2);
}
