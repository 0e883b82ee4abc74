//! Depth, normals and mask hold what is there: on a sphere, what its formula says, and the files hold the same.

use crate::shapes::{ball, drawn, plan};
use footpoint_render::{Keep, Picture, Plan, Shading, write_depth, write_mask, write_normals};
use png::Decoder;
use std::io::Cursor;

fn kept() -> (Plan<'static>, Picture) {
    let plan = Plan { planes: Keep::Yes, ..plan(Shading::Surface) };
    let picture = drawn(&ball(20_000), &plan);
    (plan, picture)
}

/// Depth and normal of the unit sphere on the ray through a pixel's middle.
fn truth(plan: &Plan<'_>, i: usize) -> Option<(f64, [f64; 3])> {
    let [width, height] = plan.size;
    let ray = plan.camera.view(width, height).ray((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
    let product = |a: [f64; 3], b: [f64; 3]| (0..3).map(|k| a[k] * b[k]).sum::<f64>();
    let (a, b) = (product(ray.direction, ray.direction), product(ray.origin, ray.direction));
    let root = b * b - a * (product(ray.origin, ray.origin) - 1.0);
    let t = (-b - root.sqrt()) / a;
    (root > 0.0).then(|| (t, std::array::from_fn(|k| ray.origin[k] + t * ray.direction[k])))
}

#[test]
fn depth_and_normals_of_a_sphere_are_those_of_its_formula() {
    let (plan, picture) = kept();
    let planes = picture.planes.unwrap();
    let (mut hits, mut apart) = (0, 0);
    for i in 0..planes.depth.len() {
        let found = !planes.depth[i].is_nan();
        apart += usize::from(found != truth(&plan, i).is_some());
        let Some((t, normal)) = truth(&plan, i).filter(|_| found) else { continue };
        hits += 1;
        // The support is 0.09: the surface lies 1e-3 inside; on slanting rays that is more.
        let slant = normal[1].abs().max(0.05);
        assert!((f64::from(planes.depth[i]) - t).abs() < 4e-3 / slant, "{i}: {} {t}", planes.depth[i]);
        let angle: f64 = (0..3).map(|k| f64::from(planes.normal[i][k]) * normal[k]).sum();
        assert!(angle > 0.99, "{i}: {angle}");
    }
    assert!(hits > 800 && apart < 12, "{hits} hits, {apart} on one side only");
}

#[test]
fn the_files_hold_the_same_numbers() {
    let (plan, picture) = kept();
    let planes = picture.planes.unwrap();
    let [near, far] = planes.depth_range();
    let mut files: [Vec<u8>; 3] = Default::default();
    write_depth(&planes, plan.size, &mut files[0]).unwrap();
    write_normals(&planes, plan.size, &mut files[1]).unwrap();
    write_mask(&planes, plan.size, &mut files[2]).unwrap();
    let [depth, normals, mask] = files.map(|file| {
        let mut reader = Decoder::new(Cursor::new(file)).read_info().unwrap();
        assert_eq!([reader.info().width as usize, reader.info().height as usize], plan.size);
        let texts: Vec<String> =
            reader.info().uncompressed_latin1_text.iter().map(|chunk| chunk.text.clone()).collect();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut bytes).unwrap();
        (bytes, texts)
    });
    assert_eq!(depth.1, [near.to_string(), far.to_string()]);
    let wide = |bytes: &[u8], i: usize| f32::from(u16::from_be_bytes([bytes[2 * i], bytes[2 * i + 1]]));
    for i in 0..planes.depth.len() {
        let level = wide(&depth.0, i);
        assert_eq!(level == 0.0, planes.depth[i].is_nan());
        assert_eq!(mask.0[i], if level > 0.0 { 255 } else { 0 });
        for k in 0..3 {
            let c = wide(&normals.0, 3 * i + k) / 65_535.0 * 2.0 - 1.0;
            if level > 0.0 {
                assert!((c - planes.normal[i][k]).abs() < 4e-5, "{i}");
            } else {
                assert_eq!(c, -1.0);
            }
        }
        if level > 0.0 {
            let read = near + (level - 1.0) / 65_534.0 * (far - near);
            assert!((read - planes.depth[i]).abs() < 1e-4 * (far - near), "{i}");
        }
    }
}

#[test]
fn depth_shading_and_its_bar_agree_with_the_planes() {
    let plan = Plan { planes: Keep::Yes, ..plan(Shading::Depth) };
    let picture = drawn(&ball(5_000), &plan);
    let [near, far] = picture.planes.unwrap().depth_range();
    let range = picture.range.unwrap();
    assert!(
        (range[0] - f64::from(near)).abs() < 1e-5 && (range[1] - f64::from(far)).abs() < 1e-5,
        "{range:?}"
    );
}
