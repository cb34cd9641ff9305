// Rapier as WebAssembly, its build that gives the same bits everywhere: its defaults, 4 solver
// iterations of 1 pass each.
import RAPIER from '@dimforge/rapier3d-deterministic-compat';

const vec = ([x, y, z]) => ({ x, y, z });
const quat = ([x, y, z, w]) => ({ x, y, z, w });

// Of a part, in the body's frame.
function colliderOf({ shape, pose, friction, restitution }, data) {
  let collider, turn = pose.rotation;
  if (shape.kind === 'sphere') {
    collider = RAPIER.ColliderDesc.ball(shape.radius);
  } else if (shape.kind === 'box') {
    collider = RAPIER.ColliderDesc.cuboid(...shape.half);
  } else if (shape.kind === 'capsule') {
    // Theirs is along y: a quarter turn about x first.
    collider = RAPIER.ColliderDesc.capsule(shape.half_length, shape.radius);
    turn = product(turn, [Math.SQRT1_2, 0, 0, Math.SQRT1_2]);
  } else if (shape.kind === 'hull') {
    collider = RAPIER.ColliderDesc.convexHull(new Float32Array(data[shape.data].points));
    if (!collider) throw new Error('it cannot have a hull');
  } else if (shape.kind === 'mesh') {
    const { vertices, indices } = data[shape.data];
    collider = RAPIER.ColliderDesc.trimesh(new Float32Array(vertices), new Uint32Array(indices));
  } else {
    collider = new RAPIER.ColliderDesc(new RAPIER.HalfSpace(vec([0, 0, 1])));
  }
  return collider.setTranslation(...pose.position).setRotation(quat(turn))
    .setFriction(friction).setRestitution(restitution).setDensity(0);
}

// Of quaternions [x, y, z, w].
function product([ax, ay, az, aw], [bx, by, bz, bw]) {
  return [aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
    aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz];
}

const DESCRIPTIONS = {
  dynamic: () => RAPIER.RigidBodyDesc.dynamic(),
  fixed: () => RAPIER.RigidBodyDesc.fixed(),
  kinematic: () => RAPIER.RigidBodyDesc.kinematicVelocityBased(),
};

export async function make(scene, dt) {
  await RAPIER.init();
  const world = new RAPIER.World(vec(scene.gravity));
  world.timestep = dt;
  const made = [], joints = [];

  function addBody(i) {
    const body = scene.bodies[i];
    const desc = DESCRIPTIONS[body.motion]()
      .setTranslation(...body.pose.position).setRotation(quat(body.pose.rotation)).setCanSleep(false);
    if (body.motion !== 'fixed') desc.setLinvel(...body.velocity).setAngvel(vec(body.spin));
    if (body.motion === 'dynamic') {
      desc.setAdditionalMassProperties(body.mass, vec([0, 0, 0]), vec(body.moments), quat([0, 0, 0, 1]));
    }
    made[i] = world.createRigidBody(desc);
    for (const part of body.parts) world.createCollider(colliderOf(part, scene.data), made[i]);
  }

  function addJoint(i) {
    const joint = scene.joints[i];
    const a = vec(joint.in_a.position), b = vec(joint.in_b.position);
    const data = joint.kind === 'ball' ? RAPIER.JointData.spherical(a, b)
      : RAPIER.JointData.revoluteWithAxes(a, b, vec(joint.z_a), vec(joint.z_b));
    const one = joints[i] = world.createImpulseJoint(data, made[joint.a], made[joint.b], true);
    one.setContactsEnabled(false);
    // The limits in a revolute joint's data are not taken over with it.
    if (joint.lower !== null) one.setLimits(joint.lower, joint.upper);
  }

  scene.bodies.forEach((body, i) => { if (body.from_start) addBody(i); });
  scene.joints.forEach((joint, i) => { if (joint.from_start) addJoint(i); });

  return {
    settings: 'float; 4 solver iterations',
    step() { world.step(); },
    launch({ body, velocity, spin }) {
      made[body]?.setLinvel(vec(velocity), true);
      made[body]?.setAngvel(vec(spin), true);
    },
    addBody,
    addJoint,
    removeJoint(i) {
      world.removeImpulseJoint(joints[i], true);
      joints[i] = null;
    },
    removeBody(i) {
      world.removeRigidBody(made[i]);
      made[i] = null;
    },
    pose(i) {
      if (!made[i]) return null;
      const p = made[i].translation(), q = made[i].rotation();
      return { p: [p.x, p.y, p.z], q: [q.x, q.y, q.z, q.w] };
    },
  };
}
