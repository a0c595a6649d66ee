# SPDX-License-Identifier: Apache-2.0
# Copyright the NeoETI authors
"""Every metric of a session, recomputed from its file by docs/metrics.md and docs/session-files.md.

Shares no code with the program: peaks are scipy's, wavelets PyWavelets'. Constants of the definitions come from the
file.
"""

from collections import namedtuple

import numpy
import pywt
import scipy.signal

NAN = float("nan")


def turned(quaternion, vector):
    """Rotates vectors (n, 3) or (3,) by unit quaternions w x y z (n, 4)."""
    w, axis = quaternion[:, :1], quaternion[:, 1:]
    across = 2.0 * numpy.cross(axis, vector)
    return vector + w * across + numpy.cross(axis, across)


def unit(vectors):
    return vectors / numpy.linalg.norm(vectors, axis=1, keepdims=True)


def dot(a, b):
    return (a * b).sum(axis=1)


def texts(data_set):
    return list(data_set.asstr()[:])


def foot(point, start, end, endless):
    """Position of a point's foot along the line from start to end, and the point's distance from it [m]."""
    way = end - start
    length = numpy.linalg.norm(way, axis=1)
    way = way / length[:, None]
    along = numpy.clip(dot(way, point - start), 0.0, numpy.inf if endless else length)
    return along, numpy.linalg.norm(point - start - along[:, None] * way, axis=1)


def passages(past, in_reach, still_there, slack):
    """Whether a point is through a gate in each step: in once it is beyond by the slack and in reach, out once it is
    before it by the slack or out of reach."""
    inside, state = [], False
    for p, reach, there in zip(past, in_reach, still_there):
        state = (not (p < -slack or not there)) if state else (p > slack and reach)
        inside.append(state)
    return numpy.array(inside)


def entries(inside):
    return inside & ~numpy.concatenate([[False], inside[:-1]])


class Steps:
    """Per-step quantities that definitions refer to."""

    def __init__(self, file):
        self.file = file
        words = file["scene/definitions/thresholds"]
        self.threshold = dict(zip(texts(words["name"]), words["value"][:]))
        number = self.threshold
        self.time = file["metrics/time_ns"][:] * 1e-9
        self.seconds = numpy.diff(self.time, prepend=self.time[0])
        names = texts(file["scene/landmarks/name"])
        places = file["tissue/landmarks"][:].astype(float)
        mark = {name: places[:, i] for i, name in enumerate(names)}
        pose = file["tools/proxy_pose"][:].astype(float)
        length = file["scene/laryngoscope"].attrs["blade_length_m"]
        direction = turned(pose[:, 3:], numpy.array([0.0, 0.0, 1.0]))
        self.blade_tip = pose[:, :3] + length * direction
        self.blade_depth = numpy.linalg.norm(self.blade_tip - mark["upper_gum"], axis=1)
        skull = file["skeleton/skull_rotation"][:].astype(float)
        in_skull = turned(skull * [1.0, -1.0, -1.0, -1.0], direction)
        self.pitch = numpy.degrees(numpy.arctan2(-in_skull[:, 2], in_skull[:, 1]))
        self.yaw = numpy.degrees(numpy.arcsin(numpy.clip(in_skull[:, 0], -1.0, 1.0)))

        left = numpy.array([1.0, 0.0, 0.0])
        gape = mark["upper_lip"] - mark["lower_lip"]
        onward = turned(skull, numpy.array([0.0, 1.0, 0.0]))
        gaping = numpy.linalg.norm(gape, axis=1) > number["lips_apart"]
        onward[gaping] = unit(numpy.cross(gape[gaping], left))
        mouth = mark["mouth_opening"]
        onward *= numpy.sign(dot(onward, mark["tongue_dorsum"] - mouth))[:, None]
        self.mouth, self.mouth_onward = mouth, onward

        def in_mouth(tip):
            past = dot(onward, tip - mouth)
            aside = numpy.linalg.norm(tip - mouth - past[:, None] * onward, axis=1)
            return passages(past, aside < number["mouth_radius"], numpy.ones(len(tip), bool), number["gate_slack"])

        self.blade_in = in_mouth(self.blade_tip)
        self.nodes = file["tools/tube_nodes"][:].astype(float)
        tip = self.tube_tip = self.nodes[:, -1]
        self.tube_grip = file["inputs/tube_grip_pose"][:, :3].astype(float)
        self.tube_in = in_mouth(tip)

        glottis, middle, carina = mark["glottis"], mark["trachea_mid"], mark["carina"]
        down = unit(numpy.cross(mark["glottis_anterior"] - mark["glottis_posterior"], left))
        down *= numpy.sign(dot(down, middle - glottis))[:, None]
        past_glottis = dot(down, tip - glottis)
        upper, from_upper = foot(tip, glottis, middle, False)
        lower, from_lower = foot(tip, middle, carina, True)
        half = numpy.linalg.norm(middle - glottis, axis=1)
        self.trachea_length = half + numpy.linalg.norm(carina - middle, axis=1)
        to_trachea = numpy.minimum(from_upper, from_lower)
        self.from_glottis = numpy.linalg.norm(tip - glottis, axis=1)
        self.along = numpy.where(past_glottis < 0.0, -self.from_glottis,
                                 numpy.where(from_upper < from_lower, upper, half + lower))
        inlet = mark["oesophagus_inlet"]
        to_oesophagus = foot(tip, inlet, mark["oesophagus_mid"], True)[1]
        past_inlet = dot(unit(mark["oesophagus_mid"] - inlet), tip - inlet)
        above_carina = self.along < self.trachea_length
        slack = number["gate_slack"]
        self.in_trachea = passages(
            past_glottis, above_carina & (to_trachea < number["glottis_radius"]) & (to_trachea < to_oesophagus),
            ~above_carina | (to_trachea < to_oesophagus + slack), slack)
        self.in_oesophagus = passages(
            past_inlet, above_carina & (to_oesophagus < number["oesophagus_radius"]) & ~(to_trachea < to_oesophagus),
            ~above_carina | (to_oesophagus < to_trachea + slack), slack)
        self.in_main_stem = passages(numpy.where(self.in_trachea, self.along, -self.from_glottis) - self.trachea_length,
                                     self.in_trachea, self.in_trachea, number["carina_slack"])
        self.tube_at_glottis = self.tube_in & (self.from_glottis < number["glottis_radius"])

        self.opening = file["metrics/glottic_opening_now"][:].astype(float)
        self.epiglottis_seen = file["metrics/epiglottis_in_sight"][:] > 0
        self.head_elevation = numpy.degrees(file["skeleton/head_elevation"][:].astype(float))
        self.saturation = file["metrics/oxygen_saturation_now"][:].astype(float)
        self.heart_rate = file["metrics/heart_rate_now"][:].astype(float)

    def force(self, tissue):
        """[N]: normal forces of the contacts with the shell, and the net force of its particles."""
        words = self.file["contacts/pressed"].attrs["description"]
        number = words[words.index(": ") + 2:].split(", ").index(tissue)
        net = self.file["contacts/net"][:, number].astype(float)
        return self.file["contacts/pressed"][:, number].astype(float) + numpy.linalg.norm(net, axis=1)

    def depth_at_lip(self, row):
        """[m], of the tube; NaN while its tip is outside."""
        nodes = self.nodes[row]
        inside = (nodes - self.mouth[row]) @ self.mouth_onward[row]
        if inside[-1] < 0.0 or not self.tube_in[row]:
            return NAN
        length = 0.0
        for i in range(len(nodes) - 1, 0, -1):
            span = numpy.linalg.norm(nodes[i] - nodes[i - 1])
            if inside[i - 1] < 0.0:
                return length + span * inside[i] / (inside[i] - inside[i - 1])
            length += span
        return length


def binned(time, values, rate):
    """Means over bins; the last, incomplete one is left out."""
    number = numpy.floor(time * rate + 1e-6).astype(int)
    return numpy.array([values[number == i].mean() for i in range(number[-1])])


def rocking(curve):
    levels = pywt.dwt_max_level(len(curve), pywt.Wavelet("sym4").dec_len)
    if levels < 1:
        return 0.0
    coarse, *details = pywt.wavedec(curve, "sym4", mode="symmetric", level=levels)
    threshold = numpy.median(numpy.abs(details[-1])) / 0.6745 * numpy.sqrt(2.0 * numpy.log(len(curve)))
    details = [pywt.threshold(detail, threshold, "soft") for detail in details]
    smooth = pywt.waverec([coarse, *details], "sym4", mode="symmetric")[:len(curve)]
    return numpy.abs(curve - smooth).max()


def peaks(curve, prominence):
    return len(scipy.signal.find_peaks(curve, prominence=prominence)[0])


def speeds(points, time, inside, every):
    """Speeds over intervals of that many steps that lie wholly inside, and the intervals [m/s, s]."""
    found, since = [], None
    for row, here in enumerate(inside):
        if not here:
            since = None
        elif since is None:
            since = row
        elif row - since == every:
            seconds = time[row] - time[since]
            found.append((numpy.linalg.norm(points[row] - points[since]) / seconds, seconds))
            since = row
    return numpy.array(found).reshape(-1, 2)


def smoothness(speed, rate):
    if len(speed) < 4 or speed.max() <= 0.0:
        return NAN
    jerk = numpy.diff(speed, 2) * rate * rate
    return -numpy.log((len(speed) / rate) ** 3 / speed.max() ** 2 * (jerk ** 2 / rate).sum())


Attempt = namedtuple("Attempt", "first last began ended values weights passed success")


def attempt(steps, first, last):
    """Rows `first` to `last` inclusive. Weights: seconds of the attempt, of the view's mean, of the tube in the mouth."""
    number = steps.threshold
    rows = slice(first, last + 1)
    time = steps.time[rows] - steps.time[first]
    seconds = steps.seconds[rows].copy()
    seconds[0] = 0.0
    found = {"attempts": 1.0, "time_s": time[-1], "over_time_limit": float(time[-1] > number["time_limit"])}
    for tissue, key in (("upper gum", "gum"), ("epiglottis", "epiglottis"), ("tongue", "tongue")):
        newtons = steps.force(tissue)[rows]
        found[f"{key}_force_n/max"] = newtons.max()
        found[f"{key}_impulse_n_s"] = (newtons * seconds).sum()
    found["gum_force_n/mean"] = found["gum_impulse_n_s"] / seconds.sum()
    depth = 100.0 * steps.blade_depth[rows]
    found["blade_depth_cm/max"] = depth.max()
    found["blade_depth_cm/mean"] = (depth * seconds).sum() / seconds.sum()

    pitch = numpy.degrees(numpy.unwrap(numpy.radians(steps.pitch[rows])))
    yaw = steps.yaw[rows]
    found["pitch_peaks"] = peaks(pitch, number["peak_prominence"])
    found["yaw_peaks"] = max(peaks(side * yaw, number["peak_prominence"]) for side in (1, -1))
    found["pitch_rocking_deg"] = rocking(binned(time, pitch, number["curve_rate"]))
    found["yaw_rocking_deg"] = rocking(binned(time, yaw, number["curve_rate"]))

    every = round(1.0 / number["speed_rate"] / numpy.median(seconds))
    blade = speeds(steps.blade_tip[rows], time, numpy.ones(len(time), bool), every)
    found["blade_path_length_cm"] = 100.0 * (blade[:, 0] * blade[:, 1]).sum()
    found["blade_smoothness"] = smoothness(blade[:-1, 0], number["speed_rate"])
    for points, key in ((steps.tube_tip, "tube_speed"), (steps.tube_grip, "tube_grip_speed")):
        tube = speeds(points[rows], time, steps.tube_in[rows], every)
        found[f"{key}_cm_per_s/max"] = 100.0 * tube[:, 0].max() if len(tube) else NAN
        found[f"{key}_cm_per_s/mean"] = 100.0 * (tube[:, 0] * tube[:, 1]).sum() / tube[:, 1].sum() if len(tube) else NAN

    opening = steps.opening[rows]
    into_trachea = entries(steps.in_trachea)[rows]
    arrived = numpy.maximum.accumulate(steps.tube_at_glottis[rows] | into_trachea)
    seen = numpy.flatnonzero(opening > 0.0)
    looking = ~arrived & (numpy.arange(len(time)) > (seen[0] if len(seen) else len(time)))
    sight = seconds[looking].sum()
    found["glottic_opening_percent/max"] = opening.max()
    found["glottic_opening_percent/mean"] = (opening * seconds)[looking].sum() / sight if sight > 0.0 else 0.0
    found["view_held_s"] = seconds[looking & (opening >= number["most_of_the_glottis"])].sum()
    found["time_to_first_view_s"] = time[seen[0]] if len(seen) else NAN
    found["cormack_lehane_grade"] = (1 if opening.max() >= number["most_of_the_glottis"] else 2 if opening.max() > 0.0
                                     else 3 if steps.epiglottis_seen[rows].any() else 4)
    passage = numpy.flatnonzero(into_trachea)
    found["head_elevation_deg"] = steps.head_elevation[rows][passage[-1] if len(passage) else numpy.argmax(opening)]
    found["oesophageal_entries"] = entries(steps.in_oesophagus)[rows].sum()
    found["main_stem_entries"] = entries(steps.in_main_stem)[rows].sum()
    found["tube_depth_at_lip_cm"] = 100.0 * steps.depth_at_lip(last)
    found["tube_depth_rule_cm"] = steps.file["scene"].attrs["weight_kg"] + 6.0
    for values, key in ((steps.saturation, "oxygen_saturation_percent"), (steps.heart_rate, "heart_rate_per_min")):
        found[f"{key}/min"] = values[rows].min()
        found[f"{key}/end"] = values[last]
    weights = {"mean over time": time[-1], "mean over time of sight": sight,
               "mean over time in the mouth": tube[:, 1].sum()}
    return Attempt(first, last, steps.time[first], steps.time[last], found, weights, len(passage) > 0,
                   intubated(steps, last))


def intubated(steps, row):
    return bool(steps.in_trachea[row] and not steps.in_main_stem[row]
                and steps.along[row] >= steps.threshold["success_depth"])


def attempts(steps):
    """Attempts that count, in order."""
    begins = numpy.flatnonzero(entries(steps.blade_in))
    ends = numpy.flatnonzero(entries(~steps.blade_in) & (numpy.arange(len(steps.time)) > 0))
    found = []
    for first in begins:
        after = ends[ends > first]
        last = after[0] if len(after) else len(steps.time) - 1
        if steps.time[last] - steps.time[first] >= steps.threshold["least_attempt"]:
            found.append(attempt(steps, first, last))
    return found


def run(steps, parts):
    """The run's metrics, from those of its attempts as the file defines."""
    words = steps.file["scene/definitions/parameters"]
    found = {}
    for key, how in zip(texts(words["key"]), texts(words["run"])):
        key = key.replace(".", "/")
        values = numpy.array([part.values[key] for part in parts], float)
        there = ~numpy.isnan(values)
        if how in ("greatest", "least", "sum"):
            found[key] = ({"greatest": max, "least": min, "sum": sum}[how](values[there]) if there.any() else NAN)
        elif how.startswith("mean"):
            weights = numpy.array([part.weights[how] for part in parts]) * there
            found[key] = (values[there] * weights[there]).sum() / weights.sum() if weights.sum() > 0.0 else values[-1]
        elif how == "at the last passage":
            passed = [part for part in parts if part.passed]
            found[key] = (passed[-1] if passed else max(parts, key=lambda part: part.values[
                "glottic_opening_percent/max"])).values[key]
        else:
            found[key] = values[-1]
    last = len(steps.time) - 1
    found["tube_depth_at_lip_cm"] = 100.0 * steps.depth_at_lip(last)
    found["oxygen_saturation_percent/end"] = steps.saturation[last]
    found["heart_rate_per_min/end"] = steps.heart_rate[last]
    between = numpy.ones(last + 1, bool)
    for part in parts:
        between[part.first:part.last + 1] = False
    found["oesophageal_entries"] += (entries(steps.in_oesophagus) & between).sum()
    found["main_stem_entries"] += (entries(steps.in_main_stem) & between).sum()
    return found
