// What the arm is made of: meshes from their text, joints one inside the other, ghost and outline.

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

// Where a camera must stand to see all points, and the middle of what it sees; points [across, towards the camera],
// slope: half the picture's width over the distance.
function fitted(points, slope) {
  let low = Infinity, high = -Infinity;
  for (const [x, z] of points) {
    low = Math.min(low, x - slope * z);
    high = Math.max(high, x + slope * z);
  }
  return { middle: 0.5 * (low + high), from: (high - low) / (2 * slope) };
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
    uniforms: { colour: { value: linear(colour) }, width: { value: 0.009 } },
    vertexShader: `uniform float width; void main() {
      vec4 p = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
      vec2 out_ = normalize((normalMatrix * normal).xy + 1e-6);
      p.xy += out_ * width * p.w * vec2(projectionMatrix[0][0] / projectionMatrix[1][1], 1.0);
      gl_Position = p; }`,
    fragmentShader: "uniform vec3 colour; void main() { gl_FragColor = vec4(colour, 1.0); }",
  }));
  return mesh;
}
