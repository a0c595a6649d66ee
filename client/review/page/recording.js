// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors

const perFrame = 7;  // x y z of the shift from rest, quaternion x y z w

function bytes(text) {
  return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
}

/// base64 of a little-endian array, as typed array.
export function array(Type, text) {
  return new Type(bytes(text).buffer);
}

async function inflated(text) {
  const stream = new Blob([bytes(text)]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/// The last entry of ascending `times` that is not after `time`; 0 where there is none.
export function indexAt(times, time) {
  let low = 0;
  let high = times.length;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) {
      low = middle;
    } else {
      high = middle;
    }
  }
  return low;
}

/// A recorded session as states at times. A state is what Viewer.show takes.
export class Recording {
  static async of(anatomy) {
    const recording = new Recording();
    const { postures, tools } = anatomy;
    const planes = await inflated(postures.differences);
    const count = planes.length / 2;
    const size = postures.time_s.length > 0 ? count / postures.time_s.length : 0;
    const values = new Int16Array(count);
    for (let i = 0; i < count; ++i) {
      values[i] = planes[i] | (planes[count + i] << 8);
      if (i >= size) {
        values[i] += values[i - size];
      }
    }
    recording.postures = values;
    recording.size = size;
    recording.postureTimes = postures.time_s;
    recording.quanta = [postures.centre_quantum_m, postures.rotation_quantum];
    recording.toolTimes = tools.time_s;
    recording.laryngoscope = array(Float32Array, tools.laryngoscope);
    recording.tube = array(Float32Array, tools.tube);
    recording.tubeSize = 3 * tools.tube_nodes;
    return recording;
  }

  get end() {
    return Math.max(this.toolTimes.at(-1) ?? 0, this.postureTimes.at(-1) ?? 0);
  }

  /// { frames: shift [m] and quaternion of each frame, laryngoscope: its pose, tube: its centre line [m] }; what was
  /// not recorded is null.
  at(time) {
    const state = { time, frames: null, laryngoscope: null, tube: null };
    if (this.postureTimes.length > 0) {
      const start = this.size * indexAt(this.postureTimes, time);
      state.frames = new Float32Array(this.size);
      for (let i = 0; i < this.size; ++i) {
        state.frames[i] = this.postures[start + i] * this.quanta[i % perFrame < 3 ? 0 : 1];
      }
    }
    if (this.toolTimes.length > 0) {
      const tool = indexAt(this.toolTimes, time);
      state.laryngoscope = this.laryngoscope.subarray(perFrame * tool, perFrame * (tool + 1));
      state.tube = this.tube.subarray(this.tubeSize * tool, this.tubeSize * (tool + 1));
    }
    return state;
  }
}
