//! dev
use fieldtrace::{clean, estimate::*, field::*, load::Scan, options::Options, raster::Raster, streamline};
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let im = image::open(&a[1]).unwrap().to_luma8();
    let gray = Raster::from_fn(im.width() as usize, im.height() as usize, |x, y| im.get_pixel(x as u32, y as u32)[0] as f32 / 255.0);
    let scan = Scan { gray, rgb: None, dpi: None };
    let t = std::time::Instant::now();
    let li = clean::clean(&scan, &Options::default());
    let t1 = t.elapsed();
    let f = StructureTensor::default().estimate(&li).unwrap();
    let t2 = t.elapsed();
    if a[3].ends_with("npz") {
        write_npz(&f, std::fs::File::create(&a[3]).unwrap()).unwrap();
        return;
    }
    let ff = FrameField::new(f);
    let s = streamline::trace(&li, &ff);
    let t3 = t.elapsed();
    eprintln!("w {} noise {} scale {} n {} solids {} | {:?} {:?} {:?}", li.line_width, li.noise, li.scale, s.len(), li.solids.len(), t1, t2 - t1, t3 - t2);
    let mut o = format!("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\"><g fill=\"none\" stroke=\"#000\" stroke-linecap=\"round\" stroke-linejoin=\"round\">", im.width(), im.height());
    for l in &s {
        o += &format!("<path stroke-width=\"{:.2}\" d=\"M", li.line_width);
        for p in &l.points { o += &format!("{:.2} {:.2} L", p.x / li.scale, p.y / li.scale); }
        o.truncate(o.len() - 1);
        if l.closed { o += "Z"; }
        o += "\"/>";
    }
    o += "</g></svg>";
    std::fs::write(&a[3], o).unwrap();
}
