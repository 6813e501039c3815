//! Tests of unit quaternions.

use super::oracle::{Exact, angle, cross, largest, norm, off, wide, worst};
use core::f32::consts::{FRAC_PI_2, PI, TAU};
use sinew_math::{Affine, Random, Rotation, Vec3, trig};

#[test]
fn from_axis_and_angle() {
    let error = worst(1, |random| {
        let (axis, angle) = (random.direction(), angle(random));
        Exact::about(wide(axis), f64::from(angle)).error(Rotation::from_axis_angle(axis, angle))
    });
    assert!(error < 4e-7, "{error}");
}

#[test]
fn about_an_axis_of_any_length() {
    let error = worst(2, |random| {
        let length = trig::pow(10.0, random.range(-37.0, 38.0));
        let (axis, angle) = (random.direction() * length, angle(random));
        Exact::about(wide(axis), f64::from(angle)).error(Rotation::about(axis, angle))
    });
    assert!(error < 4e-7, "{error}");
    for axis in [Vec3::ZERO, Vec3::NAN, Vec3::X * f32::INFINITY] {
        assert_eq!(Rotation::about(axis, 1.0), Rotation::IDENTITY);
    }
    for angle in [f32::NAN, f32::INFINITY, 0.0] {
        assert_eq!(Rotation::about(Vec3::Y, angle), Rotation::IDENTITY);
    }
    assert_eq!(Rotation::about(Vec3::Y * 1e-40, 0.0), Rotation::IDENTITY);
}

#[test]
fn to_axis_and_angle() {
    let error = worst(3, |random| {
        let rotation = random.rotation();
        let (axis, angle) = rotation.to_axis_angle();
        assert!((0.0..=PI).contains(&angle), "{angle}");
        Exact::about(wide(axis), f64::from(angle)).error(rotation)
    });
    assert!(error < 7e-7, "{error}");
    assert_eq!(Rotation::IDENTITY.to_axis_angle(), (Vec3::X, 0.0));
    assert_eq!(Rotation::from_xyzw(0.0, 0.0, 0.0, -1.0).to_axis_angle(), (Vec3::X, 0.0));
    assert_eq!(Rotation::from_xyzw(0.0, 1.0, 0.0, 0.0).to_axis_angle(), (Vec3::Y, PI));
    let (axis, angle) = Rotation::from_axis_angle(Vec3::Z, TAU - 1e-3).to_axis_angle();
    assert!((axis + Vec3::Z).length() < 1e-3 && (angle - 1e-3).abs() < 1e-6, "{axis} {angle}");
    // Even a very small angle is exact, because it is in the quaternion's vector part.
    let (axis, angle) = Rotation::from_axis_angle(Vec3::Y, 1e-30).to_axis_angle();
    assert!((axis - Vec3::Y).length() < 1e-6 && (angle / 1e-30 - 1.0).abs() < 1e-6, "{axis} {angle}");
}

#[test]
fn exponential_of_a_vector() {
    let error = worst(4, |random| {
        let vector = random.direction() * angle(random);
        let exact = Exact::about(wide(vector), norm(wide(vector)));
        let exact = if vector == Vec3::ZERO { Exact::IDENTITY } else { exact };
        exact.error(Rotation::from_scaled_axis(vector))
    });
    // The longest vectors are two full turns, where an ulp is 1e-6.
    assert!(error < 1.5e-6, "{error}");
    assert_eq!(Rotation::from_scaled_axis(Vec3::ZERO), Rotation::IDENTITY);
    assert_eq!(Rotation::from_scaled_axis(Vec3::splat(f32::NAN)), Rotation::IDENTITY);
    assert_eq!(Rotation::from_scaled_axis(Vec3::splat(1e30)), Rotation::IDENTITY);
}

#[test]
fn logarithm_undoes_the_exponential() {
    // Vectors up to half a turn; the error is relative to their length, so that small ones count.
    let error = worst(5, |random| {
        let vector = random.direction() * trig::pow(10.0, random.range(-9.0, 0.49));
        off(Rotation::from_scaled_axis(vector).to_scaled_axis(), wide(vector))
    });
    assert!(error < 1e-6, "{error}");
    let error = worst(6, |random| {
        let rotation = random.rotation();
        let vector = rotation.to_scaled_axis();
        assert!(vector.length() <= PI * 1.000_001);
        Exact::about(wide(vector), norm(wide(vector))).error(rotation)
    });
    assert!(error < 8e-7, "{error}");
    assert_eq!(Rotation::IDENTITY.to_scaled_axis(), Vec3::ZERO);
    assert_eq!(Rotation::from_xyzw(1.0, 0.0, 0.0, 0.0).to_scaled_axis(), Vec3::X * PI);
    // More than half a turn gives the short way about the opposite axis.
    let long = Rotation::from_scaled_axis(Vec3::Y * (TAU - 0.5)).to_scaled_axis();
    assert!((long + Vec3::Y * 0.5).length() < 1e-6, "{long}");
}

#[test]
fn arc_between_directions() {
    let error = worst(7, |random| {
        let from = random.direction();
        // Angles of all sizes, and close to half a turn.
        let exact = Exact::about(wide(random.direction()), f64::from(angle(random))).turn(wide(from));
        let to = Vec3::from_array(exact.map(|x| x as f32)).normalize();
        let arc = Rotation::from_arc(from, to);
        let landed = off(arc * from, wide(to));
        // The arc is the shortest: its axis is perpendicular to both vectors.
        let astray = f64::from(arc.vector().dot(from).abs());
        // Arcs are less exact near opposite directions.
        let is_less_exact = (-0.999_999..0.0).contains(&from.dot(to));
        let scale = if is_less_exact { norm(cross(wide(from), wide(to))) } else { 1.0 };
        largest([landed, astray]) * scale
    });
    assert!(error < 7e-7, "{error}");
}

#[test]
fn arc_between_opposite_and_equal_directions() {
    let error = worst(8, |random| {
        let from = random.direction();
        let (same, half) = (Rotation::from_arc(from, from), Rotation::from_arc(from, -from));
        assert_eq!(half, Rotation::from_arc(from, -from));
        Exact::IDENTITY.error(same) + off(half * from, wide(-from)) + f64::from(half.w.abs())
    });
    assert!(error < 1e-6, "{error}");
    let half = Rotation::from_arc(Vec3::Y, Vec3::NEG_Y);
    assert_eq!((half * Vec3::Y, half.w), (Vec3::NEG_Y, 0.0));
}

#[test]
fn turns_vectors() {
    let error = worst(9, |random| {
        let (rotation, v) = (random.rotation(), random.direction());
        let exact = Exact::of(rotation).turn(wide(v));
        let by_matrix = off(rotation.to_mat3() * v, exact);
        let by_quaternion = off(rotation * v, exact);
        largest([by_matrix, by_quaternion])
    });
    assert!(error < 7e-7, "{error}");
}

#[test]
fn matrix_and_back() {
    let error = worst(10, |random| {
        let rotation = random.rotation();
        Exact::of(rotation).error(Rotation::from_mat3(&rotation.to_mat3()))
    });
    assert!(error < 1e-6, "{error}");
    // Half turns about every kind of axis; there the trace is smallest.
    let error = worst(11, |random| {
        let axis = [Vec3::X, Vec3::Y, Vec3::Z, random.direction()][random.index(4)];
        let rotation = Rotation::from_axis_angle(axis, PI + random.range(-1e-3, 1e-3));
        Exact::of(rotation).error(Rotation::from_mat3(&rotation.to_mat3()))
    });
    assert!(error < 1e-6, "{error}");
}

#[test]
fn products_and_inverses() {
    let error = worst(12, |random| {
        let [a, b, c] = [random.rotation(), random.rotation(), random.rotation()];
        let [x, y, z] = [a, b, c].map(Exact::of);
        let product = x.then(y).then(z);
        largest([
            product.error((a * b) * c),
            product.error(a * (b * c)),
            x.then(y).inverse().error((a * b).inverse()),
            x.then(y).inverse().error(b.inverse() * a.inverse()),
            Exact::IDENTITY.error(a * a.inverse()),
            x.error(a * Rotation::IDENTITY),
            x.error(Rotation::IDENTITY * a),
        ])
    });
    assert!(error < 1.2e-6, "{error}");
}

#[test]
fn normalise() {
    let error = worst(13, |random| {
        let rotation = random.rotation();
        let s = trig::pow(10.0, random.range(-10.0, 17.0));
        let scaled = Rotation::from_xyzw(rotation.x * s, rotation.y * s, rotation.z * s, rotation.w * s);
        Exact::of(scaled).error(scaled.normalize())
    });
    assert!(error < 4e-7, "{error}");
    for degenerate in [0.0, 1e-13, f32::NAN, f32::INFINITY, 1e20] {
        let q = Rotation::from_xyzw(degenerate, 0.0, degenerate, 0.0);
        assert_eq!(q.normalize(), Rotation::IDENTITY, "{degenerate}");
    }
}

/// Returns the results that slerp may have by definition: `a` rotated by a share of the way to `b`, by the short way
/// and by the long one.
fn part_way(a: Exact, b: Exact, t: f64) -> [Exact; 2] {
    let [w, x, y, z] = b.then(a.inverse()).0;
    let sin = norm([x, y, z]);
    if sin < 1e-300 {
        return [a; 2];
    }
    let short = 2.0 * (sin / w).atan();
    let long = short - short.signum() * core::f64::consts::TAU;
    [short, long].map(|angle| Exact::about([x, y, z], angle * t).then(a))
}

#[test]
fn spherical_blend() {
    let error = worst(14, |random| {
        let a = random.rotation();
        let b = Rotation::from_axis_angle(random.direction(), angle(random)) * a;
        let t = random.unit();
        let [short, long] =
            part_way(Exact::of(a), Exact::of(b), f64::from(t)).map(|way| way.error(a.slerp(b, t)));
        // For rotations half a turn apart, both ways are valid.
        if a.dot(b).abs() < 1e-6 { f64::min(short, long) } else { short }
    });
    // Below 3.6° the linear blend is used, which deviates by at most this angle.
    assert!(error < 3e-6, "{error}");
}

#[test]
fn spherical_blend_at_its_edges() {
    let (a, turn) = (Rotation::from_axis_angle(Vec3::Y, 0.7), Rotation::from_axis_angle(Vec3::X, PI));
    let negated = Rotation::from_xyzw(-a.x, -a.y, -a.z, -a.w);
    for t in [0.0, 0.3, 1.0] {
        assert!(a.angle_to(a.slerp(a, t)) < 1e-6);
        assert!(a.angle_to(a.slerp(negated, t)) < 1e-6, "the same rotation");
        let half = Rotation::IDENTITY.slerp(turn, t);
        assert!((half.angle_to(Rotation::IDENTITY) - PI * t).abs() < 1e-6, "both ways must be half a turn");
    }
    assert!(a.angle_to(a.slerp(turn, 0.0)) < 1e-6 && turn.angle_to(a.slerp(turn, 1.0)) < 1e-6);
}

#[test]
fn linear_blend_takes_the_same_path() {
    let error = worst(15, |random| {
        let (a, b, t) = (random.rotation(), random.rotation(), random.unit());
        let (start, end) = (Exact::of(a), Exact::of(b));
        let whole = end.then(start.inverse());
        let part = Exact::of(a.nlerp(b, t)).then(start.inverse());
        // The axis is the same, so the result is on the great circle.
        let (v, w) = ([1, 2, 3].map(|i| whole.0[i]), [1, 2, 3].map(|i| part.0[i]));
        assert!(part.angle() <= whole.angle() + 1e-6);
        norm(cross(v, w))
    });
    assert!(error < 1e-6, "{error}");
    let (a, b) = (Rotation::from_axis_angle(Vec3::X, 0.2), Rotation::from_axis_angle(Vec3::X, 1.2));
    assert!(a.slerp(b, 0.5).angle_to(a.nlerp(b, 0.5)) < 1e-6, "slerp and nlerp must agree at the middle");
}

#[test]
fn swing_times_twist() {
    let error = worst(16, |random| {
        let (rotation, axis) = (random.rotation(), random.direction());
        let (swing, twist) = rotation.swing_twist(axis);
        let swing_along = f64::from(swing.vector().dot(axis).abs());
        let twist_across = f64::from(twist.vector().cross(axis).length());
        let angle = rotation.twist_angle(axis);
        let twist_angle = Exact::about(wide(axis), f64::from(angle)).error(twist);
        largest([Exact::of(rotation).error(swing * twist), swing_along, twist_across, twist_angle])
    });
    assert!(error < 2e-6, "{error}");
    // A swing of half a turn has no twist.
    let upside_down = Rotation::from_axis_angle(Vec3::X, PI);
    assert_eq!(upside_down.swing_twist(Vec3::Y).1, Rotation::IDENTITY);
    assert_eq!(Rotation::IDENTITY.swing_twist(Vec3::Y), (Rotation::IDENTITY, Rotation::IDENTITY));
    let twisted = Rotation::from_axis_angle(Vec3::Y, 3.0);
    assert!((twisted.twist_angle(Vec3::Y) - 3.0).abs() < 1e-6);
}

#[test]
fn angular_velocity_between_two() {
    let error = worst(17, |random| {
        let (start, dt) = (random.rotation(), random.range(0.001, 2.0));
        let turn = random.direction() * random.range(0.0, 3.1);
        let velocity = turn / dt;
        let found = start.angular_velocity_to(start.integrate(velocity, dt), dt);
        norm(wide(found - velocity)) * f64::from(dt)
    });
    assert!(error < 1.5e-6, "{error}");
    // A rotation by more than half a turn appears as a smaller one in the opposite direction.
    let seen = Rotation::IDENTITY.angular_velocity_to(Rotation::from_axis_angle(Vec3::Z, 1.5 * PI), 1.0);
    assert!((seen + Vec3::Z * FRAC_PI_2).length() < 1e-6, "{seen}");
}

#[test]
fn ten_thousand_products_stay_rotations() {
    let mut random = Random::new(18);
    let mut rotation = Rotation::IDENTITY;
    for _ in 0..10_000 {
        rotation = rotation.integrate(random.in_cube() * 10.0, 0.01);
    }
    assert!((rotation.length() - 1.0).abs() < 3e-7, "{}", rotation.length());
}

/// A rotation of the space above, converted to a mirrored frame, equals the conversion by the frame's rigid part.
#[test]
fn a_mirrored_frame_conjugates_like_its_rigid_part() {
    let turn = Rotation::from_scaled_axis(Vec3::new(0.4, -1.1, 0.3));
    let change = Rotation::from_scaled_axis(Vec3::new(-0.7, 0.2, 0.9));
    for scale in [Vec3::new(-2.0, 2.0, 2.0), Vec3::splat(-0.2), Vec3::new(1.0, 1.0, -1.0), Vec3::ONE] {
        let frame = Affine::from_scale_rotation_translation(scale, turn, Vec3::X);
        let rigid = frame.to_rigid().rotation;
        let within = Affine { linear: frame.inverse().linear * change.to_mat3() * frame.linear, ..frame };
        let expected = rigid.inverse() * change * rigid;
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            let away = within.vector(axis) - expected * axis;
            assert!(away.length() < 1e-5, "scale {scale}: axis {axis} is off by {away}");
        }
    }
}
