// A body in space: the quad that just hides the sphere from the eye, on which each fragment finds where its ray meets
// the sphere, and so the depth and the normal.
flat varying vec3 v_colour;
flat varying vec4 v_sphere;         // centre in eye space, radius
varying vec3 v_eye;                 // the point of the quad in eye space

#ifdef VERTEX
uniform float u_focal;              // pixels in a unit at distance 1

void main() {
    vec3 centre = eye_from_centre(place_now());
    float distance = length(centre);
    float pixel = distance / u_focal;
    float radius = max(a_form.x, max(u_least_radius, 0.75) * u_point * pixel);
    v_colour = colour_now();
    v_sphere = vec4(centre, radius);
    if (distance <= radius * 1.001 || centre.z >= 0.0) {
        gl_Position = vec4(2.0, 2.0, 2.0, 1.0);     // the eye is inside, or the sphere behind it
        return;
    }
    // In the plane through the centre across the line of sight the silhouette has the radius r d / sqrt(d^2 - r^2).
    float reach = radius * distance * inversesqrt(distance * distance - radius * radius) + pixel;
    vec3 sight = centre / distance;
    vec3 right = normalize(cross(sight, vec3(0.0, 1.0, 0.0)));
    vec3 above = cross(right, sight);
    vec2 corner = 2.0 * corner_of_quad() - 1.0;
    v_eye = centre + reach * (corner.x * right + corner.y * above);
    gl_Position = u_projection * vec4(v_eye, 1.0);
}
#else
uniform float u_focal;
uniform int u_multisampled;
uniform vec3 u_ground;
uniform vec2 u_haze;                // distance where it begins, and one over its depth
out vec4 colour;

void main() {
    vec3 centre = v_sphere.xyz;
    float radius = v_sphere.w;
    vec3 ray = normalize(v_eye);
    float nearest = dot(ray, centre);
    float miss = length(centre - nearest * ray);
    float coverage = clamp((radius - miss) * u_focal / nearest + 0.5, 0.0, 1.0);
    if (coverage <= 0.0 || (u_multisampled == 0 && coverage < 0.5)) {
        discard;
    }
    float half_chord = sqrt(max(radius * radius - miss * miss, 0.0));
    vec3 hit = (nearest - half_chord) * ray;
    vec3 normal = (hit - centre) / radius;

    float facing = max(-dot(normal, ray), 0.0);
    float light = max(dot(normal, vec3(-0.42, 0.62, 0.66)), 0.0);
    float gloss = pow(max(dot(normal, normalize(vec3(-0.42, 0.62, 0.66) - ray)), 0.0), 48.0);
    vec3 shaded = v_colour * (0.47 + 0.13 * normal.y + 0.54 * light) * mix(0.62, 1.0, smoothstep(0.0, 0.45, facing));
    shaded += 0.22 * gloss;
    float haze = 0.55 * clamp((-hit.z - u_haze.x) * u_haze.y, 0.0, 1.0);
    colour = vec4(mix(shaded, u_ground, haze), coverage);

    vec4 clip = u_projection * vec4(hit, 1.0);
    gl_FragDepth = 0.5 + 0.5 * clip.z / clip.w;
}
#endif
