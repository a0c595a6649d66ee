// SPDX-License-Identifier: Apache-2.0
// Copyright the NeoETI authors
import {
  AmbientLight, BackSide, BufferAttribute, BufferGeometry, CatmullRomCurve3, Color, DirectionalLight, FrontSide, Group,
  Line, LineBasicMaterial, Matrix4, Mesh, MeshBasicMaterial, MeshLambertMaterial, PerspectiveCamera, Plane, Quaternion,
  Scene, TubeGeometry, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { array } from "./recording.js";

const carriers = 8;  // frames that carry a point at most
// By tissue, in the order of the session file: soft, tongue, epiglottis, larynx, trachea, oesophagus, gums, palate, skull,
// mandible, spine, hyoid, vocal cord, lip, cloth.
const colours = ["#e3b3a0", "#c8616a", "#e8909c", "#d9828c", "#8fb7d9", "#b48a5a", "#e08a98", "#e08a98", "#dd9a9c",
  "#ece3cd", "#ece3cd", "#ece3cd", "#ece3cd", "#fbf3ea", "#c9706c", "#a9bccb"].map((text) => new Color(text));
const bladePath = "#0b5cad";
const tubePath = "#8a4b00";

/// The frames that carry a surface turn and shift its points: linear blend skinning.
class Skinned {
  constructor(surface, centres) {
    this.rest = array(Float32Array, surface.rest);
    this.frames = array(Uint16Array, surface.frames);
    this.weights = array(Uint8Array, surface.weights);
    this.centres = centres;
    this.geometry = new BufferGeometry();
    this.positions = new BufferAttribute(this.rest.slice(), 3);
    this.geometry.setAttribute("position", this.positions);
    this.geometry.setIndex(new BufferAttribute(array(Uint32Array, surface.triangles), 1));
    const tissues = array(Uint8Array, surface.tissues);
    const tints = new Float32Array(this.rest.length);
    tissues.forEach((tissue, i) => colours[tissue % colours.length].toArray(tints, 3 * i));
    this.geometry.setAttribute("color", new BufferAttribute(tints, 3));
    this.geometry.computeVertexNormals();
  }

  /// `maps`: 12 numbers a frame, rows of its matrix and offset.
  move(maps) {
    const { rest, frames, weights } = this;
    const out = this.positions.array;
    for (let i = 0; i < rest.length / 3; ++i) {
      const [x, y, z] = [rest[3 * i], rest[3 * i + 1], rest[3 * i + 2]];
      let [sx, sy, sz, whole] = [0, 0, 0, 0];
      for (let k = carriers * i; k < carriers * (i + 1); ++k) {
        const weight = weights[k];
        if (weight > 0) {
          const m = 12 * frames[k];
          sx += weight * (maps[m] * x + maps[m + 1] * y + maps[m + 2] * z + maps[m + 3]);
          sy += weight * (maps[m + 4] * x + maps[m + 5] * y + maps[m + 6] * z + maps[m + 7]);
          sz += weight * (maps[m + 8] * x + maps[m + 9] * y + maps[m + 10] * z + maps[m + 11]);
          whole += weight;
        }
      }
      if (whole > 0) {
        out[3 * i] = sx / whole;
        out[3 * i + 1] = sy / whole;
        out[3 * i + 2] = sz / whole;
      }
    }
    this.positions.needsUpdate = true;
    this.geometry.computeVertexNormals();
    this.geometry.computeBoundingSphere();
  }
}

/// Tools over the deforming anatomy, in a canvas. What it shows comes through show() alone, from a recording or live.
export class Viewer {
  constructor(anatomy, width, height) {
    this.centres = array(Float32Array, anatomy.frame_rest_centre);
    this.renderer = new WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
    this.renderer.localClippingEnabled = true;
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.scene = new Scene();
    this.scene.background = new Color("#dfe5ea");
    this.scene.add(new AmbientLight("#ffffff", 1.3));
    this.camera = new PerspectiveCamera(32, 1, 0.005, 5);
    const sun = new DirectionalLight("#ffffff", 2.2);
    sun.position.set(0.6, -0.5, 0.6);
    this.camera.add(sun);
    this.scene.add(this.camera);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener("change", () => this.draw());

    this.plane = new Plane(new Vector3(-1, 0, 0), 0);  // what lies to the patient's left is cut away
    this.tissue = new Group();
    this.surfaces = anatomy.surfaces.map((surface) => {
      const skinned = new Skinned(surface, this.centres);
      const outside = new MeshLambertMaterial({ vertexColors: true, side: FrontSide });
      // Seen from inside, a cut body looks filled where its back faces have one flat colour.
      const inside = new MeshBasicMaterial({ vertexColors: true, side: BackSide });
      inside.color.set("#9a8a86");
      skinned.materials = [outside, inside];
      this.tissue.add(new Mesh(skinned.geometry, outside), new Mesh(skinned.geometry, inside));
      return skinned;
    });
    this.scene.add(this.tissue);

    const blade = new BufferGeometry();
    blade.setAttribute("position", new BufferAttribute(array(Float32Array, anatomy.tools.vertices), 3));
    blade.setIndex(new BufferAttribute(array(Uint32Array, anatomy.tools.triangles), 1));
    blade.computeVertexNormals();
    this.laryngoscope = new Mesh(blade, new MeshLambertMaterial({ color: "#7d8790" }));
    this.laryngoscope.matrixAutoUpdate = false;
    this.bladeTip = new Vector3(0, 0, anatomy.tools.blade_length_m);
    this.tube = new Mesh(new BufferGeometry(), new MeshLambertMaterial({ color: "#f2d16b" }));
    this.tubeRadius = Math.max(anatomy.tools.tube_diameter_m / 2, 5e-4);
    this.scene.add(this.laryngoscope, this.tube);
    this.paths = [bladePath, tubePath].map((colour) => {
      // Seen through tissue, as most of a path lies in it.
      const line = new Line(new BufferGeometry(), new LineBasicMaterial({ color: colour, depthTest: false }));
      line.renderOrder = 1;
      line.frustumCulled = false;
      this.scene.add(line);
      return line;
    });
    const glottis = anatomy.landmarks?.glottis ?? [0, 0, 0];
    const gum = anatomy.landmarks?.upper_gum ?? [0, 0, 0];
    this.middle = new Vector3(...glottis).add(new Vector3(...gum)).multiplyScalar(0.5);
    this.resize(width, height);
    this.cut(true);
    this.look("near");
  }

  /// From where: "beside" (the patient's left), "near" (the same, on the airway), "above" (over the face), "eye" (along
  /// the blade's usual way).
  look(from) {
    const away = { beside: [0.42, -0.05, 0.02], near: [0.25, -0.02, 0], above: [0.06, -0.44, 0.12],
      eye: [0.02, -0.22, 0.34] }[from];
    this.camera.up.set(...(from === "above" ? [0, 0, 1] : [0, -1, 0]));
    this.camera.position.copy(this.middle).add(new Vector3(...away));
    this.controls.target.copy(this.middle);
    this.controls.update();
    this.draw();
  }

  /// Whether the patient's left is cut away.
  cut(on) {
    for (const surface of this.surfaces) {
      surface.materials.forEach((material) => { material.clippingPlanes = on ? [this.plane] : []; });
    }
    this.draw();
  }

  resize(width, height) {
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  /// The whole ways of both tips, as arrays of x y z [m].
  showPaths(blade, tube) {
    [blade, tube].forEach((points, i) =>
      this.paths[i].geometry.setAttribute("position", new BufferAttribute(points, 3)));
  }

  bladeTipAt(pose) {
    return this.bladeTip.clone().applyQuaternion(new Quaternion(...pose.slice(3))).add(new Vector3(...pose.slice(0, 3)));
  }

  /// Shows a state: frames, laryngoscope and tube as Recording.at() describes them, and so many points of the paths.
  show(state, pathPoints = 0) {
    if (state.frames) {
      const maps = this.maps(state.frames);
      this.surfaces.forEach((surface) => surface.move(maps));
    }
    this.laryngoscope.visible = state.laryngoscope !== null;
    if (state.laryngoscope) {
      const pose = state.laryngoscope;
      this.laryngoscope.matrix.compose(new Vector3(...pose.slice(0, 3)), new Quaternion(...pose.slice(3)),
        new Vector3(1, 1, 1));
      this.laryngoscope.matrixWorldNeedsUpdate = true;
    }
    this.tube.visible = state.tube !== null && state.tube.length >= 6;
    if (this.tube.visible) {
      const nodes = [];
      for (let i = 0; i < state.tube.length; i += 3) {
        nodes.push(new Vector3(...state.tube.slice(i, i + 3)));
      }
      this.tube.geometry.dispose();
      this.tube.geometry = new TubeGeometry(new CatmullRomCurve3(nodes), 48, this.tubeRadius, 10);
    }
    this.paths.forEach((path) => path.geometry.setDrawRange(0, pathPoints));
    this.draw();
  }

  /// What each frame does to rest points: 12 numbers, rows of matrix and offset.
  maps(frames) {
    const count = this.centres.length / 3;
    const maps = new Float32Array(12 * count);
    const turn = new Matrix4();
    const rotation = new Quaternion();
    for (let f = 0; f < count; ++f) {
      rotation.fromArray(frames, 7 * f + 3).normalize();
      const e = turn.makeRotationFromQuaternion(rotation).elements;
      const [x, y, z] = this.centres.subarray(3 * f, 3 * f + 3);
      for (let row = 0; row < 3; ++row) {
        const m = 12 * f + 4 * row;
        [maps[m], maps[m + 1], maps[m + 2]] = [e[row], e[4 + row], e[8 + row]];
        maps[m + 3] = this.centres[3 * f + row] + frames[7 * f + row] - (e[row] * x + e[4 + row] * y + e[8 + row] * z);
      }
    }
    return maps;
  }

  draw() {
    this.renderer.render(this.scene, this.camera);
  }

  /// What it shows now, as an address of a picture.
  picture() {
    this.draw();
    return this.renderer.domElement.toDataURL("image/jpeg", 0.9);
  }
}
