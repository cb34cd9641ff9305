// Rapier as WebAssembly, its build that gives the same bits everywhere: its defaults, 4 solver
// iterations of 1 pass each.
import RAPIER from '@dimforge/rapier3d-deterministic-compat';

const vec = ([x, y, z]) => ({ x, y, z });
const quat = ([x, y, z, w]) => ({ x, y, z, w });

function colliderOf(shape) {
  if (shape.kind === 'sphere') return RAPIER.ColliderDesc.ball(shape.radius);
  if (shape.kind === 'box') return RAPIER.ColliderDesc.cuboid(...shape.half);
  if (shape.kind === 'capsule') {
    // Theirs is along y: a quarter turn about x.
    return RAPIER.ColliderDesc.capsule(shape.half_length, shape.radius)
      .setRotation(quat([Math.SQRT1_2, 0, 0, Math.SQRT1_2]));
  }
  return new RAPIER.ColliderDesc(new RAPIER.HalfSpace(vec([0, 0, 1])));
}

export async function make(scene, dt) {
  await RAPIER.init();
  const world = new RAPIER.World(vec(scene.gravity));
  world.timestep = dt;
  const made = scene.bodies.map((body) => {
    const moves = body.motion === 'dynamic';
    const part = body.parts[0];
    const desc = (moves ? RAPIER.RigidBodyDesc.dynamic() : RAPIER.RigidBodyDesc.fixed())
      .setTranslation(...body.pose.position).setRotation(quat(body.pose.rotation)).setCanSleep(false);
    const collider = colliderOf(part.shape).setFriction(part.friction).setRestitution(part.restitution);
    collider.setDensity(0);
    if (moves) {
      desc.setLinvel(...body.velocity).setAngvel(vec(body.spin));
      desc.setAdditionalMassProperties(body.mass, vec([0, 0, 0]), vec(body.moments), quat([0, 0, 0, 1]));
    }
    const one = world.createRigidBody(desc);
    world.createCollider(collider, one);
    return one;
  });
  for (const joint of scene.joints) {
    const a = vec(joint.in_a.position), b = vec(joint.in_b.position);
    const data = joint.kind === 'ball' ? RAPIER.JointData.spherical(a, b)
      : RAPIER.JointData.revoluteWithAxes(a, b, vec(joint.z_a), vec(joint.z_b));
    const one = world.createImpulseJoint(data, made[joint.a], made[joint.b], true);
    one.setContactsEnabled(false);
    // The limits in a revolute joint's data are not taken over with it.
    if (joint.lower !== null) one.setLimits(joint.lower, joint.upper);
  }

  return {
    settings: 'float; 4 solver iterations',
    step() { world.step(); },
    launch({ body, velocity, spin }) {
      made[body].setLinvel(vec(velocity), true);
      made[body].setAngvel(vec(spin), true);
    },
    pose(i) {
      const p = made[i].translation(), q = made[i].rotation();
      return { p: [p.x, p.y, p.z], q: [q.x, q.y, q.z, q.w] };
    },
  };
}
