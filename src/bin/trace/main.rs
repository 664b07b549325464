//! dev
use fieldtrace::{drawing::*, field::*, load::Scan, options::Options, pipeline::Vectorizer, raster::Raster};
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let im = image::open(&a[1]).unwrap().to_luma8();
    let gray = Raster::from_fn(im.width() as usize, im.height() as usize, |x, y| im.get_pixel(x as u32, y as u32)[0] as f32 / 255.0);
    let scan = Scan { gray, rgb: None, dpi: None };
    let v = Vectorizer::new(Options::default()).unwrap();
    if a[3].ends_with("npz") {
        write_npz(&v.field(&scan).unwrap(), std::fs::File::create(&a[3]).unwrap()).unwrap();
        return;
    }
    let d = v.trace(&scan).unwrap();
    let mut o = format!("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\"><g fill=\"none\" stroke=\"#000\" stroke-linecap=\"round\" stroke-linejoin=\"round\">", im.width(), im.height());
    for f in &d.fills { o += &format!("<path fill=\"#000\" stroke=\"none\" d=\"{}\"/>", f.outline.to_svg()); }
    for s in &d.strokes {
        match &s.centreline {
            Centreline::Circle(c) => o += &format!("<circle stroke-width=\"{:.2}\" cx=\"{:.2}\" cy=\"{:.2}\" r=\"{:.2}\"/>", s.width, c.center.x, c.center.y, c.radius),
            Centreline::Dot(p) => o += &format!("<path stroke-width=\"{:.2}\" d=\"M{:.2} {:.2}h0.01\"/>", s.width, p.x, p.y),
            c => o += &format!("<path stroke-width=\"{:.2}\" d=\"{}\"/>", s.width, c.to_path().to_svg()),
        }
    }
    o += "</g></svg>";
    std::fs::write(&a[3], o).unwrap();
}
