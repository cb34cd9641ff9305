// Jolt as WebAssembly: its defaults, 10 velocity and 2 position iterations, one collision step; no
// damping, as nobody else has any.
import load from 'jolt-physics';

// The build's working memory of 10 MB, which nothing changes, has room for so many contacts; a pile has
// about three for each body.
const MOST_CONTACTS = 21000;

const STANDING = 0, MOVING = 1;  // object layers, and broad phase layers

function layers(Jolt, settings) {
  const pairs = new Jolt.ObjectLayerPairFilterTable(2);
  pairs.EnableCollision(STANDING, MOVING);
  pairs.EnableCollision(MOVING, MOVING);
  const broad = new Jolt.BroadPhaseLayerInterfaceTable(2, 2);
  broad.MapObjectToBroadPhaseLayer(STANDING, new Jolt.BroadPhaseLayer(STANDING));
  broad.MapObjectToBroadPhaseLayer(MOVING, new Jolt.BroadPhaseLayer(MOVING));
  settings.mObjectLayerPairFilter = pairs;
  settings.mBroadPhaseLayerInterface = broad;
  settings.mObjectVsBroadPhaseLayerFilter = new Jolt.ObjectVsBroadPhaseLayerFilterTable(broad, 2, pairs, 2);
}

export async function make(scene, dt) {
  const count = scene.bodies.length;
  if (3.5 * count > MOST_CONTACTS) throw new Error(`its build has room for ${MOST_CONTACTS} contacts`);
  const Jolt = await load();
  const settings = new Jolt.JoltSettings();
  settings.mMaxBodies = count + 16;
  settings.mMaxBodyPairs = 32 * count + 1024;
  settings.mMaxContactConstraints = Math.min(16 * count + 1024, MOST_CONTACTS);
  settings.mMaxWorkerThreads = 0;
  layers(Jolt, settings);
  const jolt = new Jolt.JoltInterface(settings);
  const system = jolt.GetPhysicsSystem();
  const bodies = system.GetBodyInterface();
  const vec = ([x, y, z]) => new Jolt.Vec3(x, y, z);
  const rvec = ([x, y, z]) => new Jolt.RVec3(x, y, z);
  system.SetGravity(vec(scene.gravity));

  // Turns a capsule of ours, along z, into one of theirs, along y: a quarter turn about x.
  const alongZ = new Jolt.Quat(Math.SQRT1_2, 0, 0, Math.SQRT1_2);
  const shapeOf = (shape) => {
    if (shape.kind === 'sphere') return new Jolt.SphereShape(shape.radius);
    if (shape.kind === 'box') return new Jolt.BoxShape(vec(shape.half));
    if (shape.kind === 'capsule') {
      const own = new Jolt.CapsuleShapeSettings(shape.half_length, shape.radius);
      return new Jolt.RotatedTranslatedShapeSettings(vec([0, 0, 0]), alongZ, own).Create().Get();
    }
    return new Jolt.PlaneShape(new Jolt.Plane(vec([0, 0, 1]), 0));
  };

  // Who is joined does not meet: one table of the pairs of all bodies that have joints.
  const place = new Map();
  for (const { a, b } of scene.joints) for (const i of [a, b]) if (!place.has(i)) place.set(i, place.size);
  const filter = place.size > 0 ? new Jolt.GroupFilterTable(place.size) : null;
  for (const { a, b } of scene.joints) filter.DisableCollision(place.get(a), place.get(b));

  const made = scene.bodies.map((body, i) => {
    const moves = body.motion === 'dynamic';
    const [x, y, z, w] = body.pose.rotation;
    const creation = new Jolt.BodyCreationSettings(shapeOf(body.parts[0].shape), rvec(body.pose.position),
      new Jolt.Quat(x, y, z, w), moves ? Jolt.EMotionType_Dynamic : Jolt.EMotionType_Static,
      moves ? MOVING : STANDING);
    creation.mFriction = body.parts[0].friction;
    creation.mRestitution = body.parts[0].restitution;
    creation.mLinearDamping = creation.mAngularDamping = 0;
    creation.mAllowSleeping = false;
    if (place.has(i)) creation.mCollisionGroup = new Jolt.CollisionGroup(filter, 0, place.get(i));
    if (moves) {
      creation.mOverrideMassProperties = Jolt.EOverrideMassProperties_MassAndInertiaProvided;
      creation.mMassPropertiesOverride.mMass = body.mass;
      creation.mMassPropertiesOverride.mInertia = Jolt.Mat44.prototype.sScaleVec3(vec(body.moments));
      creation.mLinearVelocity = vec(body.velocity);
      creation.mAngularVelocity = vec(body.spin);
    }
    const one = bodies.CreateBody(creation);
    bodies.AddBody(one.GetID(), Jolt.EActivation_Activate);
    Jolt.destroy(creation);
    return one;
  });

  for (const joint of scene.joints) {
    let creation;
    if (joint.kind === 'ball') {
      creation = new Jolt.PointConstraintSettings();
    } else {
      creation = new Jolt.HingeConstraintSettings();
      creation.mHingeAxis1 = vec(joint.z_a);
      creation.mHingeAxis2 = vec(joint.z_b);
      creation.mNormalAxis1 = vec(joint.x_a);
      creation.mNormalAxis2 = vec(joint.x_b);
      if (joint.lower !== null) {
        creation.mLimitsMin = joint.lower;
        creation.mLimitsMax = joint.upper;
      }
    }
    creation.mSpace = Jolt.EConstraintSpace_LocalToBodyCOM;
    creation.mPoint1 = rvec(joint.in_a.position);
    creation.mPoint2 = rvec(joint.in_b.position);
    system.AddConstraint(creation.Create(made[joint.a], made[joint.b]));
  }
  system.OptimizeBroadPhase();

  return {
    settings: 'float; 10 velocity, 2 position iterations',
    step() { jolt.Step(dt, 1); },
    launch({ body, velocity, spin }) {
      bodies.SetLinearAndAngularVelocity(made[body].GetID(), vec(velocity), vec(spin));
    },
    pose(i) {
      const p = made[i].GetPosition(), q = made[i].GetRotation();
      return { p: [p.GetX(), p.GetY(), p.GetZ()], q: [q.GetX(), q.GetY(), q.GetZ(), q.GetW()] };
    },
  };
}
