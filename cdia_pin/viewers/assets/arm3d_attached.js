// What acts on the whole arm: a force as an arrow at its link, a payload as a ball at the tool.

const DENSITY = 2000; // [kg/m³], by which a ball's size says its mass
const PUSH = "#cc3f9c", BODY = "#b8862f";

class Attached {
  // root: the arm in base axes; groups: its joints by name; reach: its size [m]; weight: its weight [N].
  constructor(root, groups, reach, weight) {
    this.groups = groups;
    this.root = root;
    this.reach = reach;
    // A force of half the arm's weight is as long as the arm; rounded, so that the scale can be said.
    this.scale = rounded((0.5 * weight) / reach); // [N/m]
    const tube = 0.009 * Math.min(reach, 1.6);
    const ink = new THREE.MeshBasicMaterial({ color: linear(PUSH), depthTest: false, transparent: true, opacity: 0.95 });
    this.head = new THREE.Mesh(new THREE.ConeGeometry(2.8 * tube, 7 * tube, 24).translate(0, -3.5 * tube, 0), ink); // tip at 0, along y
    this.shaft = new THREE.Mesh(new THREE.CylinderGeometry(tube, tube, 1, 20).translate(0, -0.5, 0), ink);
    this.arrow = new THREE.Group();
    this.arrow.add(this.head, this.shaft);
    for (const part of this.arrow.children) part.renderOrder = 6;
    root.add(this.arrow);
    this.skin = new THREE.MeshStandardMaterial({ color: linear(BODY), roughness: 0.5, transparent: true });
    this.ball = new THREE.Mesh(new THREE.SphereGeometry(1, 32, 20), this.skin);
    this.ball.castShadow = true;
    this.show(null);
  }

  // Show {push, body}; null nothing.
  show(now) {
    this.now = now;
    const push = now && now.push, body = now && now.body;
    this.arrow.visible = Boolean(push);
    this.ball.visible = Boolean(body);
    if (push) this._point(push);
    if (body) {
      this.groups.get(body.joint).add(this.ball);
      this.ball.position.set(...body.at);
      this.ball.scale.setScalar(Math.cbrt((3 * Math.abs(body.mass)) / (4 * Math.PI * DENSITY)) || 1e-6);
      this.skin.opacity = body.mass < 0 ? 0.35 : 1; // something that the model has is missing
    }
  }

  // Length of the arrow of a force [m]: by the scale, but never too short or too long to be seen.
  length(force) {
    return Math.min(Math.max(Math.hypot(...force) / this.scale, 0.12 * this.reach), 0.6 * this.reach);
  }

  _point(push) {
    this.arrow.position.copy(inBase(this.groups.get(push.joint), this.root, push.at));
    this.arrow.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), new THREE.Vector3(...push.force).normalize());
    this.shaft.scale.set(1, this.length(push.force), 1);
  }

  // What is shown, in words, with its place in the window's own frame.
  pins() {
    const at = (object, point) => object.localToWorld(point);
    const { push, body } = this.now || {};
    return [
      push && { words: push.words, at: at(this.arrow, new THREE.Vector3(0, -this.length(push.force), 0)) },
      body && { words: body.words, at: at(this.ball, new THREE.Vector3()) },
    ];
  }

  // Rows of the legend: what the signs mean, with their scale.
  legend() {
    const { push, body } = this.now || {};
    return [
      push && ["arrow: 10 cm for " + this.scale / 10 + " N", PUSH],
      body && ["ball: " + DENSITY / 1000 + " kg per litre", BODY],
    ].filter(Boolean);
  }
}

// A point of a joint's frame in the frame of the base.
function inBase(group, root, at) {
  const point = new THREE.Vector3(...at);
  for (let o = group; o !== root; o = o.parent) {
    o.updateMatrix();
    point.applyMatrix4(o.matrix);
  }
  return point;
}

// The nearest of 1, 2 and 5 times a power of ten.
function rounded(x) {
  const ten = 10 ** Math.floor(Math.log10(x));
  return ten * [1, 2, 5, 10].reduce((best, k) => (Math.abs(Math.log((k * ten) / x)) < Math.abs(Math.log((best * ten) / x)) ? k : best));
}
