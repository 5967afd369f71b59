// What the picture is made of: meshes from their text, lights, ground, and the mark of a missing torque.

const THREE = MeshCat.THREE;

const matrixOf = (rows) => new THREE.Matrix4().set(...rows);
const linear = (hex) => new THREE.Color(hex).convertSRGBToLinear();
const displayed = (colour) => "#" + colour.clone().convertLinearToSRGB().getHexString();

function numbers(text, Kind) {
  const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  return new Kind(bytes.buffer); // little-endian, as every machine with a browser is
}

function geometryOf(mesh) {
  const steps = numbers(mesh.vertices, Uint16Array);
  const at = new Float32Array(steps.length);
  for (let k = 0; k < steps.length; k++) {
    const axis = k % 3;
    at[k] = mesh.low[axis] + (steps[k] / 65535) * (mesh.high[axis] - mesh.low[axis]);
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(at, 3));
  geometry.setIndex(new THREE.BufferAttribute(numbers(mesh.triangles, mesh.wide ? Uint32Array : Uint16Array), 1));
  geometry.computeVertexNormals(); // vertices are split along sharp edges already
  geometry.computeBoundingBox();
  geometry.computeBoundingSphere();
  return geometry;
}

// The corners of a mesh's bounding box where it is now.
function corners(mesh) {
  const { min, max } = mesh.geometry.boundingBox;
  return [0, 1, 2, 3, 4, 5, 6, 7].map((k) =>
    new THREE.Vector3(k & 1 ? max.x : min.x, k & 2 ? max.y : min.y, k & 4 ? max.z : min.z).applyMatrix4(mesh.matrixWorld));
}

// A group for each joint, one inside the other; turning or sliding it moves all that comes after.
function chainOf(joints) {
  const root = new THREE.Group();
  const groups = new Map([[null, root]]);
  for (const joint of joints) {
    const placed = new THREE.Group(), moved = new THREE.Group();
    matrixOf(joint.placement).decompose(placed.position, placed.quaternion, placed.scale);
    placed.add(moved);
    groups.get(joint.parent).add(placed);
    groups.set(joint.name, moved);
  }
  return { root, groups };
}

function move(group, joint, axis, q) {
  if (joint.kind === "prismatic") group.position.copy(axis).multiplyScalar(q);
  else group.quaternion.setFromAxisAngle(axis, q);
}

function ghostOf(geometry) {
  // The first pass writes depth alone, so that the second shows the outer surface and not every wall behind it. Both
  // stand a little back: where the arm is where it should be, no ghost is seen.
  const back = { transparent: true, polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 8 };
  const depth = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ ...back, colorWrite: false }));
  const skin = new THREE.Mesh(geometry, new THREE.MeshLambertMaterial({ ...back, opacity: 0.34, depthWrite: false }));
  depth.renderOrder = 1;
  skin.renderOrder = 2;
  return [depth, skin];
}

function outlineOf(geometry, colour) {
  const mesh = new THREE.Mesh(geometry, new THREE.ShaderMaterial({
    side: THREE.BackSide,
    uniforms: { colour: { value: linear(colour) }, width: { value: 0.006 } },
    vertexShader: `uniform float width; void main() {
      vec4 p = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
      vec2 out_ = normalize((normalMatrix * normal).xy + 1e-6);
      p.xy += out_ * width * p.w * vec2(projectionMatrix[0][0] / projectionMatrix[1][1], 1.0);
      gl_Position = p; }`,
    fragmentShader: "uniform vec3 colour; void main() { gl_FragColor = vec4(colour, 1.0); }",
  }));
  return mesh;
}

function lightsOf(reach) {
  const group = new THREE.Group();
  const sky = new THREE.HemisphereLight(0xffffff, 0xb4b9c0, 0.52);
  sky.position.set(0, 0, 1);
  const key = new THREE.DirectionalLight(0xfff8ef, 0.5), rim = new THREE.DirectionalLight(0xe6f0ff, 0.22);
  key.position.set(0.9, -0.9, 1.9).multiplyScalar(reach);
  rim.position.set(-1, 1.2, 0.7).multiplyScalar(reach);
  key.castShadow = true;
  key.shadow.mapSize.set(1024, 1024);
  key.shadow.radius = 5;
  key.shadow.normalBias = 0.004 * reach;
  Object.assign(key.shadow.camera, { left: -reach, right: reach, top: reach, bottom: -reach, near: 0.1 * reach, far: 5 * reach });
  group.add(sky, key, key.target, rim);
  return group;
}

function groundOf(reach, height) {
  const group = new THREE.Group();
  const shadow = new THREE.Mesh(new THREE.PlaneGeometry(8 * reach, 8 * reach), new THREE.ShadowMaterial({ opacity: 0.2, depthWrite: false }));
  shadow.receiveShadow = true;
  const lines = new THREE.Mesh(new THREE.PlaneGeometry(8 * reach, 8 * reach), new THREE.ShaderMaterial({
    transparent: true, depthWrite: false, side: THREE.DoubleSide, extensions: { derivatives: true },
    uniforms: { ink: { value: new THREE.Color() }, reach: { value: reach } },
    vertexShader: "varying vec2 at; void main() { at = position.xy; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }",
    fragmentShader: `uniform vec3 ink; uniform float reach; varying vec2 at;
      float line(float step_) { vec2 p = at / step_, d = abs(fract(p - 0.5) - 0.5) / fwidth(p); return 1.0 - min(min(d.x, d.y), 1.0); }
      void main() { float fade = 1.0 - smoothstep(0.5 * reach, 2.4 * reach, length(at));
        gl_FragColor = vec4(ink, fade * max(0.10 * line(0.1), 0.22 * line(0.5))); }`,
  }));
  group.add(shadow, lines);
  group.position.z = height;
  group.ink = lines.material.uniforms.ink.value;
  return group;
}

// An arc about a joint's axis, or an arrow along it; built once at full size, shown in part.
class TorqueMark {
  constructor(reach) {
    const material = new THREE.MeshBasicMaterial({ side: THREE.DoubleSide, depthTest: false, transparent: true, opacity: 0.95 });
    const radius = 0.12 * reach, tube = 0.011 * reach;
    this.material = material;
    this.radius = radius;
    this.arc = new THREE.Mesh(ring(radius, tube, 1.6 * Math.PI, TorqueMark.STEPS, TorqueMark.SIDES), material);
    this.shaft = new THREE.Mesh(new THREE.CylinderGeometry(tube, tube, 1, 20).rotateX(Math.PI / 2).translate(0, 0, 0.5), material);
    this.head = new THREE.Mesh(new THREE.ConeGeometry(2.7 * tube, 6 * tube, 24), material); // points along y
    this.group = new THREE.Group();
    this.group.add(this.arc, this.shaft, this.head);
    for (const part of this.group.children) part.renderOrder = 5;
    this.group.visible = false;
  }

  // Show a share in [−1, 1] of the largest torque, about or along an axis.
  show(parent, axis, prismatic, share, colour) {
    const size = Math.min(Math.abs(share), 1), length = Math.max(size, 0.12);
    parent.add(this.group);
    this.group.visible = true;
    this.group.quaternion.setFromUnitVectors(new THREE.Vector3(0, 0, 1), axis);
    this.group.scale.set(1, 1, 1);
    this.material.color.copy(linear(colour));
    this.arc.visible = !prismatic;
    this.shaft.visible = prismatic;
    if (prismatic) {
      const reach = 2.4 * this.radius * length;
      this.shaft.scale.set(1, 1, reach);
      this.head.position.set(0, 0, reach);
      this.head.rotation.set(Math.PI / 2, 0, 0);
      if (share < 0) this.group.scale.z = -1;
    } else {
      const shown = Math.max(2, Math.round(length * TorqueMark.STEPS)), angle = (1.6 * Math.PI * shown) / TorqueMark.STEPS;
      this.arc.geometry.setDrawRange(0, shown * TorqueMark.SIDES * 6);
      this.head.position.set(this.radius * Math.cos(angle), this.radius * Math.sin(angle), 0);
      this.head.rotation.set(0, 0, angle);
      if (share < 0) this.group.scale.y = -1;
    }
  }

  hide() { this.group.visible = false; }
}
TorqueMark.STEPS = 64;
TorqueMark.SIDES = 12;

// A piece of a torus whose triangles come in the order of its angle: a draw range shows as much of it as is wanted.
function ring(radius, tube, angle, steps, sides) {
  const at = [], index = [];
  for (let i = 0; i <= steps; i++) {
    for (let k = 0; k < sides; k++) {
      const a = (angle * i) / steps, b = (2 * Math.PI * k) / sides, r = radius + tube * Math.cos(b);
      at.push(r * Math.cos(a), r * Math.sin(a), tube * Math.sin(b));
    }
  }
  for (let i = 0; i < steps; i++) {
    for (let k = 0; k < sides; k++) {
      const a = i * sides + k, b = i * sides + ((k + 1) % sides);
      index.push(a, a + sides, b, b, a + sides, b + sides);
    }
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(at, 3));
  geometry.setIndex(index);
  return geometry;
}
