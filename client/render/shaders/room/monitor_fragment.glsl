// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
// The patient monitor's screen: electrocardiogram and plethysmogram with their numbers. Place on the screen
// from 0 to 1 in red and green of the colour. Defines: none.
in vec4 colour_at;
out vec4 pixel;
uniform sampler2D traces;   // by column: lowest and highest value of each curve
uniform int head;           // column at which the sweep stands
uniform int heart_rate, saturation;   // negative: none
const float aspect = 98.0 / 60.0;
// Segments of a digit, from the top clockwise, then the middle: bits 0 to 6.
const int digits[11] = int[11](63, 6, 91, 79, 102, 109, 125, 7, 127, 111, 64);
// Letters H R S P O of 3 x 5 pixels, upper left in the highest bit.
const int letters[5] = int[5](23533, 31661, 31183, 31716, 31599);
float bar(vec2 p, vec2 a, vec2 b) {
    vec2 along = b - a;
    return length(p - a - clamp(dot(p - a, along) / dot(along, along), 0.0, 1.0) * along);
}
// Distance to a digit one unit high and half as wide, its lower left at the origin; 10: a dash.
float digit_at(int digit, vec2 p) {
    const vec2 corner[6] = vec2[6](vec2(0.0, 1.0), vec2(0.5, 1.0), vec2(0.5, 0.5), vec2(0.5, 0.0), vec2(0.0, 0.0), vec2(0.0, 0.5));
    float nearest = 1.0;
    for (int k = 0; k < 6; ++k) {
        if ((digits[digit] >> k & 1) == 1) {
            nearest = min(nearest, bar(p, corner[k], corner[(k + 1) % 6]));
        }
    }
    return (digits[digit] & 64) != 0 ? min(nearest, bar(p, corner[5], corner[2])) : nearest;
}
// Coverage of a number of up to three digits, right-aligned at `right`, of this height.
float number_at(int number, vec2 p, vec2 right, float height) {
    vec2 q = (p - right) / height;
    int place = int(floor(-q.x / 0.8));
    int shown = number < 0 ? (place < 2 ? 10 : -1) : place == 0 ? number % 10 : place == 1 && number > 9 ? number / 10 % 10 : place == 2 && number > 99 ? number / 100 : -1;
    if (shown < 0 || place < 0 || q.y < -0.2 || q.y > 1.2) {
        return 0.0;
    }
    float away = digit_at(shown, vec2(q.x + 0.8 * float(place) + 0.65, q.y));
    float soft = fwidth(p.y) / height;
    return 1.0 - smoothstep(0.065 - soft, 0.065 + soft, away);
}
float letter_at(int letter, vec2 p, vec2 left, float height) {
    ivec2 at = ivec2(floor(vec2(5.0, 5.0) * (p - left) / height));
    at.y = 4 - at.y;
    bool inside = at.x >= 0 && at.x < 3 && at.y >= 0 && at.y < 5;
    return inside && (letters[letter] >> (14 - 3 * at.y - at.x) & 1) == 1 ? 1.0 : 0.0;
}
// Coverage of a curve whose values of the column range over `range`.
float curve_at(float y, vec2 range, float zero, float height) {
    float half_width = max(0.006, 0.7 * fwidth(y));
    vec2 ends = zero + height * range;
    return 1.0 - smoothstep(0.5 * half_width, 1.5 * half_width, max(max(ends.x - y, y - ends.y), 0.0));
}
void main() {
    vec2 at = colour_at.rg;
    vec2 p = vec2(at.x * aspect, at.y);
    const vec3 green = vec3(0.10, 0.95, 0.25), cyan = vec3(0.10, 0.75, 1.0);
    vec3 sum = vec3(0.004, 0.006, 0.008);
    const float right = 0.66;   // of the curves
    if (at.x > 0.03 && at.x < right) {
        float along = (at.x - 0.03) / (right - 0.03) * float(textureSize(traces, 0).x);
        int column = int(along);
        float ahead = mod(along - float(head), float(textureSize(traces, 0).x));
        // Ahead of the sweep the old curves are erased.
        float kept = smoothstep(8.0, 12.0, ahead) + (ahead < 1.0 ? 1.0 : 0.0);
        vec4 value = texelFetch(traces, ivec2(column, 0), 0);
        sum += kept * green * curve_at(at.y, value.xy, 0.62, 0.27);
        sum += kept * cyan * curve_at(at.y, value.zw, 0.12, 0.26);
    }
    sum += green * number_at(heart_rate, p, vec2(0.965 * aspect, 0.60), 0.26);
    sum += cyan * number_at(saturation, p, vec2(0.965 * aspect, 0.12), 0.26);
    const vec2 label = vec2(0.70 * aspect, 0.90);
    sum += green * (letter_at(0, p, label, 0.06) + letter_at(1, p, label + vec2(0.05, 0.0), 0.06));
    for (int k = 0; k < 3; ++k) {
        sum += cyan * letter_at(2 + k, p, vec2(0.70 * aspect + 0.05 * float(k), 0.42), 0.06);
    }
    sum += 0.03 * (1.0 - smoothstep(0.0, fwidth(at.y) + 0.003, abs(at.y - 0.5))) * step(0.03, at.x);
    pixel = vec4(sum, 1.0);
}
