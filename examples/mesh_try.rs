//! Try.
use patchlight::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let error: f64 = a[2].parse().unwrap();
    let me: f64 = a[3].parse().unwrap();
    let imported = scene::import::read_scene(std::path::Path::new(&a[1]), &Default::default()).unwrap();
    let mut o = solve::SolveOptions::default();
    o.error = error;
    let cpu = || { let t = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime); t.tv_sec as f64 + t.tv_nsec as f64 * 1e-9 };
    let c0 = cpu();
    let (e, r) = pipeline::solve(imported.scene, &o, &Default::default(), &progress::Silent).unwrap();
    let c1 = cpu();
    let m = e.lit_mesh(me, &progress::Silent).unwrap();
    let c2 = cpu();
    println!("mesh {:.2}% claimed {:.2}%", 100.*m.error().0, 100.*m.error().1); println!("solve {:.2} claimed {:.2}% mesh {:.2} CPU-s, {} elements {} nodes, rays/pt {}", c1 - c0, 100. * r.error.estimate, c2 - c1, m.elements(), m.nodes(), e.solution().point_rays());
    // points and references
    let pts = std::fs::read_to_string(&a[4]).unwrap();
    let mut points = vec![]; let mut refs: Vec<f64> = vec![];
    for l in pts.lines().skip(1) {
        let f: Vec<f64> = l.split(',').map(|x| x.parse().unwrap()).collect();
        points.push(scene::SurfacePoint { position: [f[0], f[1], f[2]], normal: [f[3], f[4], f[5]] });
        refs.extend(&f[6..9]);
    }
    let v = e.mesh_values(&m, &points);
    let c3 = cpu();
    let vv = e.values_at(&points, &progress::Silent).unwrap().radiosity;
    let c4 = cpu();
    let err = |v: &[f32]| {
        let l: Vec<f64> = refs.chunks(3).map(|r| r.iter().map(|x| x * x).sum::<f64>()).collect();
        let mut s = l.clone(); s.sort_by(|a, b| a.total_cmp(b)); let m = s[s.len() / 2];
        let d: Vec<f64> = v.chunks(3).zip(refs.chunks(3)).zip(&l).map(|((v, r), l)| v.iter().zip(r).map(|(v, r)| (*v as f64 - r).powi(2)).sum::<f64>() / l.max(m)).collect();
        let en = (v.iter().zip(&refs).map(|(v, r)| (*v as f64 - r).powi(2)).sum::<f64>() / refs.iter().map(|r| r * r).sum::<f64>()).sqrt();
        ((d.iter().sum::<f64>() / d.len() as f64).sqrt(), en)
    };
    if std::env::var("WORST").is_ok() {
        let l: Vec<f64> = refs.chunks(3).map(|r| r.iter().map(|x| x * x).sum::<f64>()).collect();
        let mut so = l.clone(); so.sort_by(|a, b| a.total_cmp(b)); let med = so[so.len() / 2];
        let mut d: Vec<(f64, usize)> = (0..l.len()).map(|i| ((0..3).map(|c| (v[3*i+c] as f64 - refs[3*i+c]).powi(2)).sum::<f64>() / l[i].max(med), i)).collect();
        d.sort_by(|a, b| b.0.total_cmp(&a.0));
        let tot: f64 = d.iter().map(|x| x.0).sum();
        for &(e, i) in d.iter().take(24) { println!("{:.1}% of squares at {:?} n {:?}: mesh {:.3} values {:.3} ref {:.3} (typical {:.3})", 100.*e/tot, points[i].position, points[i].normal, v[3*i], vv[3*i], refs[3*i], med.sqrt()/1.7); }
    }
    println!("mesh local {:.2}% energy {:.2}%; values local {:.2}% energy {:.2}% ({:.2} CPU-s for {} points)", 100. * err(&v).0, 100. * err(&v).1, 100. * err(&vv).0, 100. * err(&vv).1, c4 - c3, points.len());
}
