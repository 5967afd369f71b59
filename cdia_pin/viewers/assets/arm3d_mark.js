// The mark of a missing torque.

// An arc about a joint's axis, or an arrow along it; built once at full size, shown in part.
class TorqueMark {
  constructor(reach) {
    const material = new THREE.MeshBasicMaterial({ side: THREE.DoubleSide, depthTest: false, transparent: true, opacity: 0.95 });
    const radius = 0.085 * reach, tube = 0.0075 * reach;
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
