// Draws surfaces lit by one sun with shadows and by the sky, the sky itself, and lines, like `sinew_picture` on the processor.

struct View {
    clip_from_world: mat4x4<f32>,
    sun_from_world: mat4x4<f32>,
    // w: length of a texel of the shadow map, metres
    eye: vec4<f32>,
    // a ray through the picture is corner + across·u + down·v
    corner: vec4<f32>,
    across: vec4<f32>,
    down: vec4<f32>,
    to_sun: vec4<f32>,
    sun: vec4<f32>,
    zenith: vec4<f32>,
    // w: square of the distance at which haze hides half of a surface
    horizon: vec4<f32>,
    ground: vec4<f32>,
    above: vec4<f32>,
    // width and height in pixels, half the width of a line in pixels, 1 if the shader must write sRGB bytes
    target_size: vec4<f32>,
}

@group(0) @binding(0) var<uniform> view: View;
// Three texels for each matrix, its rows; rows of 512 matrices. The data are in a texture, because WebGL2 has no storage
// buffers.
@group(0) @binding(1) var palette: texture_2d<f32>;
@group(1) @binding(0) var shadow_map: texture_depth_2d;
@group(1) @binding(1) var shadow_sampler: sampler_comparison;
@group(2) @binding(0) var picture: texture_2d<f32>;
@group(2) @binding(1) var picture_sampler: sampler;

struct Instance {
    @location(4) row0: vec4<f32>,
    @location(5) row1: vec4<f32>,
    @location(6) row2: vec4<f32>,
    // linear; w: opacity
    @location(7) color: vec4<f32>,
    // second colour of a checker; w: side of its squares, 0 for none
    @location(8) other: vec4<f32>,
    // x: first matrix of the palette; y: 1 if only the outside is drawn
    @location(9) info: vec4<f32>,
}

struct Vertex {
    @location(0) position: vec3<f32>,
    // (0, 0, 0) for flat faces
    @location(1) normal: vec3<f32>,
    @location(2) uv: vec2<f32>,
    @location(3) color: vec3<f32>,
}

struct Skin {
    @location(10) slots: vec4<u32>,
    @location(11) weights: vec4<f32>,
}

struct Surface {
    @builtin(position) clip: vec4<f32>,
    @location(0) world: vec3<f32>,
    @location(1) normal: vec3<f32>,
    @location(2) uv: vec2<f32>,
    @location(3) color: vec4<f32>,
    @location(4) @interpolate(flat) other: vec4<f32>,
    @location(5) @interpolate(flat) tint: vec3<f32>,
    @location(6) @interpolate(flat) outside: f32,
}

struct Placed {
    world: vec3<f32>,
    normal: vec3<f32>,
}

fn place(position: vec3<f32>, normal: vec3<f32>, rows: mat3x4<f32>) -> Placed {
    let p = vec4(position, 1.0);
    // Normals are transformed by the cofactors, times the sign of the determinant.
    let x = vec3(rows[0].x, rows[1].x, rows[2].x);
    let y = vec3(rows[0].y, rows[1].y, rows[2].y);
    let z = vec3(rows[0].z, rows[1].z, rows[2].z);
    let side = select(1.0, -1.0, dot(x, cross(y, z)) < 0.0);
    let n = (cross(y, z) * normal.x + cross(z, x) * normal.y + cross(x, y) * normal.z) * side;
    return Placed(vec3(dot(rows[0], p), dot(rows[1], p), dot(rows[2], p)), n);
}

fn blended(skin: Skin, first: u32) -> mat3x4<f32> {
    var rows = mat3x4<f32>(vec4(0.0), vec4(0.0), vec4(0.0));
    for (var i = 0u; i < 4u; i++) {
        let matrix = first + skin.slots[i];
        let at = vec2(matrix % 512u * 3u, matrix / 512u);
        let x = textureLoad(palette, at, 0);
        let y = textureLoad(palette, at + vec2(1u, 0u), 0);
        let z = textureLoad(palette, at + vec2(2u, 0u), 0);
        rows += mat3x4<f32>(x, y, z) * skin.weights[i];
    }
    return rows;
}

fn surface(placed: Placed, vertex: Vertex, instance: Instance) -> Surface {
    var out: Surface;
    out.clip = view.clip_from_world * vec4(placed.world, 1.0);
    out.world = placed.world;
    out.normal = placed.normal;
    out.uv = vertex.uv;
    out.color = vec4(vertex.color, instance.color.w);
    out.other = instance.other;
    out.tint = instance.color.xyz;
    out.outside = instance.info.y;
    return out;
}

@vertex
fn solid_vertex(vertex: Vertex, instance: Instance) -> Surface {
    let rows = mat3x4<f32>(instance.row0, instance.row1, instance.row2);
    return surface(place(vertex.position, vertex.normal, rows), vertex, instance);
}

@vertex
fn skin_vertex(vertex: Vertex, instance: Instance, skin: Skin) -> Surface {
    let rows = blended(skin, u32(instance.info.x));
    return surface(place(vertex.position, vertex.normal, rows), vertex, instance);
}

@vertex
fn solid_shadow(vertex: Vertex, instance: Instance) -> @builtin(position) vec4<f32> {
    let rows = mat3x4<f32>(instance.row0, instance.row1, instance.row2);
    return view.sun_from_world * vec4(place(vertex.position, vertex.normal, rows).world, 1.0);
}

@vertex
fn skin_shadow(vertex: Vertex, instance: Instance, skin: Skin) -> @builtin(position) vec4<f32> {
    let rows = blended(skin, u32(instance.info.x));
    return view.sun_from_world * vec4(place(vertex.position, vertex.normal, rows).world, 1.0);
}

// Integral of the square wave from 0: rises to 1 at odd numbers and falls to 0 at even ones.
fn triangle_wave(x: vec2<f32>) -> vec2<f32> {
    let t = x * 0.5;
    return 1.0 - abs((t - floor(t)) * 2.0 - 1.0);
}

// Share of a checker's second colour in the box that a pixel covers (both along x and z).
fn checker(p: vec2<f32>, covered: vec2<f32>) -> f32 {
    let width = clamp(covered, vec2(1e-3), vec2(8.0));
    let mean = (triangle_wave(p + 0.5 * width) - triangle_wave(p - 0.5 * width)) / width;
    return 0.5 - 0.5 * clamp(mean.x, -1.0, 1.0) * clamp(mean.y, -1.0, 1.0);
}

// Share of the sunlight that reaches a point: nine taps, each of four texels.
fn sunlight(world: vec3<f32>, face: vec3<f32>) -> f32 {
    let slant = 1.0 - clamp(dot(face, view.to_sun.xyz), 0.0, 1.0);
    let lifted = world + face * (view.eye.w * (0.8 + 2.2 * slant));
    let clip = view.sun_from_world * vec4(lifted, 1.0);
    let uv = clip.xy * vec2(0.5, -0.5) + 0.5;
    let texel = 1.0 / vec2<f32>(textureDimensions(shadow_map));
    var light = 0.0;
    for (var y = -1; y <= 1; y++) {
        for (var x = -1; x <= 1; x++) {
            let at = uv + vec2(f32(x), f32(y)) * texel;
            light += textureSampleCompareLevel(shadow_map, shadow_sampler, at, clip.z);
        }
    }
    let outside = any(uv < vec2(0.0)) || any(uv > vec2(1.0));
    return select(light / 9.0, 1.0, outside);
}

fn encoded(linear: vec3<f32>) -> vec3<f32> {
    let x = clamp(linear, vec3(0.0), vec3(1.0));
    let curve = 1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055;
    let bytes = select(curve, x * 12.92, x <= vec3(0.0031308));
    return select(x, bytes, view.target_size.w > 0.5);
}

@fragment
fn surface_fragment(in: Surface, @builtin(front_facing) front: bool) -> @location(0) vec4<f32> {
    let across = dpdx(in.world);
    let down = dpdy(in.world);
    let texture_color = textureSample(picture, picture_sampler, in.uv).xyz;
    if (in.outside > 0.5 && !front) {
        discard;
    }
    let to_eye = view.eye.xyz - in.world;
    var face = normalize(cross(down, across));
    face = select(face, -face, dot(face, to_eye) < 0.0);
    var normal = face;
    if (dot(in.normal, in.normal) > 1e-12) {
        normal = normalize(select(-in.normal, in.normal, front));
    }
    var base = in.tint;
    if (in.other.w > 0.0) {
        let covered = (abs(across) + abs(down)) / in.other.w;
        base = mix(base, in.other.xyz, checker(in.world.xz / in.other.w, covered.xz));
    }
    base = base * in.color.xyz * texture_color;
    let around = mix(view.ground.xyz, view.above.xyz, 0.5 + 0.5 * normal.y);
    let cos = max(dot(normal, view.to_sun.xyz), 0.0);
    let lit = base * (around + view.sun.xyz * (cos * sunlight(in.world, face)));
    let distance = dot(to_eye, to_eye);
    let seen = mix(lit, view.horizon.xyz, distance / (distance + view.horizon.w));
    return vec4(encoded(seen), in.color.w);
}

struct Sky {
    @builtin(position) clip: vec4<f32>,
    @location(0) uv: vec2<f32>,
}

@vertex
fn sky_vertex(@builtin(vertex_index) index: u32) -> Sky {
    let uv = vec2(f32(index / 2u) * 2.0, f32(index % 2u) * 2.0);
    return Sky(vec4(uv.x * 2.0 - 1.0, 1.0 - uv.y * 2.0, 0.0, 1.0), uv);
}

@fragment
fn sky_fragment(in: Sky) -> @location(0) vec4<f32> {
    let ray = normalize(view.corner.xyz + view.across.xyz * in.uv.x + view.down.xyz * in.uv.y);
    return vec4(encoded(mix(view.horizon.xyz, view.zenith.xyz, sqrt(clamp(ray.y, 0.0, 1.0)))), 1.0);
}

struct Stroke {
    @builtin(position) clip: vec4<f32>,
    @location(0) color: vec3<f32>,
}

// Two triangles along a line, of the width in the view.
@vertex
fn line_vertex(
    @builtin(vertex_index) index: u32,
    @location(0) from_point: vec3<f32>,
    @location(1) to_point: vec3<f32>,
    @location(2) color: vec3<f32>,
) -> Stroke {
    var a = view.clip_from_world * vec4(from_point, 1.0);
    var b = view.clip_from_world * vec4(to_point, 1.0);
    // Clips a line to the part before the eye.
    let near = 0.01;
    if (a.w < near && b.w < near) {
        return Stroke(vec4(0.0, 0.0, -1.0, 1.0), color);
    }
    if (a.w < near) {
        a = mix(a, b, (near - a.w) / (b.w - a.w));
    } else if (b.w < near) {
        b = mix(b, a, (near - b.w) / (a.w - b.w));
    }
    let size = view.target_size.xy;
    let way = (b.xy / b.w - a.xy / a.w) * size;
    let along = select(vec2(1.0, 0.0), normalize(way), dot(way, way) > 1e-12);
    let off = vec2(-along.y, along.x) * view.target_size.z * 2.0 / size;
    let is_end = index == 1u || index == 2u || index == 4u;
    let is_left = index == 0u || index == 1u || index == 3u;
    var end = a;
    if (is_end) {
        end = b;
    }
    let side = select(-1.0, 1.0, is_left);
    // A line on a surface is drawn a little nearer, so that the surface does not hide it.
    return Stroke(vec4(end.xy + off * side * end.w, end.z * 1.004, end.w), color);
}

@fragment
fn line_fragment(in: Stroke) -> @location(0) vec4<f32> {
    return vec4(encoded(in.color), 1.0);
}
