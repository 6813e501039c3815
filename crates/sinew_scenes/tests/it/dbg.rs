use sinew::math::*;
use sinew::physics::*;
use sinew_scenes::walks::*;

#[test]
fn dbg() {
    let cases = [
        (0u64, Vec3::new(-3.7464013, 0.00747627, 5.2801685), Vec3::new(-3.6464014, 0.18265943, 5.2801685)),
        (3u64, Vec3::new(-3.7874599, 0.007491529, 4.9989815), Vec3::new(-3.8874598, 0.27182114, 4.9989815)),
        (9u64, Vec3::new(4.679531, 0.007188618, 3.6344826), Vec3::new(4.779531, 0.17709295, 3.6344826)),
        (15u64, Vec3::new(-4.740485, 0.14387074, -0.5155133), Vec3::new(-4.840485, 0.39015955, -0.5155133)),
        (17u64, Vec3::new(-0.248698, 0.25163707, -1.4974971), Vec3::new(-0.248698, 0.3802233, -1.5974971)),
        (22u64, Vec3::new(4.6433396, 0.0074834228, 3.56252), Vec3::new(4.5433397, 0.2647817, 3.56252)),
        (24u64, Vec3::new(-4.2381377, 0.0067079663, -5.0808887), Vec3::new(-4.3381376, 0.100242406, -5.0808887)),
        (26u64, Vec3::new(2.3409274, 0.0074889064, -3.150086), Vec3::new(2.2409275, 0.2518754, -3.150086)),
        (28u64, Vec3::new(-0.67858016, 0.0071972013, -2.0161917), Vec3::new(-0.67858016, 0.2582386, -1.9161917)),
        (35u64, Vec3::new(2.8245716, 0.007466972, 5.009018), Vec3::new(2.9245715, 0.17922223, 5.009018)),
        (45u64, Vec3::new(4.6388836, 0.007490158, 2.94665), Vec3::new(4.5388837, 0.24159488, 2.94665)),
        (61u64, Vec3::new(-4.8321204, 0.1126965, 2.2107909), Vec3::new(-4.7321205, 0.26783237, 2.2107909)),
        (79u64, Vec3::new(1.5390635, 0.007471621, 0.2727192), Vec3::new(1.5390635, 0.23149753, 0.3727192)),
        (98u64, Vec3::new(-1.8184382, 0.007317066, -2.4753754), Vec3::new(-1.9184382, 0.24700773, -2.4753754)),
    ];
    for (seed, at, to) in cases {
        let t = Terrain::clutter(seed);
        let w = t.build();
        println!("== seed {seed} from {at} to {to}");
        let shape = Shape::Capsule { half_height: 0.6, radius: 0.3 };
        let way = (to - at) * Vec3::new(1.0, 0.0, 1.0);
        for k in 0..7 {
            let p = at + way * (k as f32 / 6.0);
            let probe = Probe { shape: shape.clone(), world_from_shape: Transform::from_translation(p + Vec3::Y * (0.9 + 0.345)) };
            let hit = w.query().first(&ShapeCast { probe: probe.clone(), translation: Vec3::Y * -0.5 });
            if let Some(hit) = hit {

                println!("  {k}: falls {:.3} normal.y {:.3} point.y {:.3} start {:?} {:?}", hit.fraction * 0.5 - 0.345, hit.normal.y, hit.point.y, hit.start.is_some(), hit.body);
            }
        }
    }
}
