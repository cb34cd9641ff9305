// Jolt as WebAssembly: its defaults, 10 velocity and 2 position iterations, one collision step; no
// damping, as nobody else has any.
import load from 'jolt-physics';

// The build's working memory of 10 MB, which nothing changes, has room for so many contacts; a pile has
// about three for each body.
const MOST_CONTACTS = 21000;

// In its memory of 128 MB a mesh of more cannot be built; it is given as several.
const MOST_TRIANGLES = 150000;

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

// The most dynamic bodies that are there at once.
function mostAtOnce(scene) {
  let there = scene.bodies.filter((b) => b.from_start && b.motion === 'dynamic').length, most = there;
  for (const { kind, index } of scene.events) {
    if (kind === 'addBody' && scene.bodies[index].motion === 'dynamic') most = Math.max(most, ++there);
    if (kind === 'removeBody' && scene.bodies[index].motion === 'dynamic') --there;
  }
  return most;
}

export async function make(scene, dt) {
  const moving = mostAtOnce(scene);
  const count = moving + scene.bodies.filter((b) => b.motion !== 'dynamic').length;
  if (3.5 * moving > MOST_CONTACTS) throw new Error(`its build has room for ${MOST_CONTACTS} contacts`);
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
  // Theirs is not collected: each is to be destroyed.
  const freed = (thing, use) => {
    const result = use(thing);
    Jolt.destroy(thing);
    return result;
  };
  const withVec = ([x, y, z], use) => freed(new Jolt.Vec3(x, y, z), use);
  const withRVec = ([x, y, z], use) => freed(new Jolt.RVec3(x, y, z), use);
  const withQuat = ([x, y, z, w], use) => freed(new Jolt.Quat(x, y, z, w), use);
  withVec(scene.gravity, (g) => system.SetGravity(g));

  const created = (shapeSettings) => {
    const result = shapeSettings.Create();
    if (result.HasError()) throw new Error(result.GetError().c_str());
    return result.Get();
  };
  const hullOf = ({ points }) => {
    const hull = new Jolt.ConvexHullShapeSettings();
    for (let k = 0; k < points.length; k += 3) {
      withVec(points.slice(k, k + 3), (p) => hull.mPoints.push_back(p));
    }
    return created(hull);
  };
  // Corners from..to, with the vertices that they name.
  const pieceOf = ({ vertices, indices }, from, to) => {
    const mesh = new Jolt.MeshShapeSettings(), names = new Map();
    for (let k = from; k < to; ++k) {
      const v = indices[k];
      if (names.has(v)) continue;
      names.set(v, names.size);
      freed(new Jolt.Float3(...vertices.slice(3 * v, 3 * v + 3)), (p) => mesh.mTriangleVertices.push_back(p));
    }
    for (let k = from; k < to; k += 3) {
      const [a, b, c] = indices.slice(k, k + 3).map((v) => names.get(v));
      freed(new Jolt.IndexedTriangle(a, b, c, 0), (t) => mesh.mIndexedTriangles.push_back(t));
    }
    const made = created(mesh);
    made.AddRef();
    Jolt.destroy(mesh);
    return made;
  };
  const meshOf = (data) => {
    const count = data.indices.length;
    if (count <= 3 * MOST_TRIANGLES) return pieceOf(data, 0, count);
    const compound = new Jolt.StaticCompoundShapeSettings();
    for (let from = 0; from < count; from += 3 * MOST_TRIANGLES) {
      const piece = pieceOf(data, from, Math.min(from + 3 * MOST_TRIANGLES, count));
      withVec([0, 0, 0], (p) => withQuat([0, 0, 0, 1], (q) => compound.AddShapeShape(p, q, piece, 0)));
    }
    return created(compound);
  };
  // Turns a capsule of ours, along z, into one of theirs, along y: a quarter turn about x.
  const alongZ = [Math.SQRT1_2, 0, 0, Math.SQRT1_2];
  const shared = [];
  const shapeOf = (shape) => {
    if (shape.kind === 'sphere') return new Jolt.SphereShape(shape.radius);
    if (shape.kind === 'box') return withVec(shape.half, (half) => new Jolt.BoxShape(half));
    if (shape.kind === 'capsule') {
      const own = new Jolt.CapsuleShapeSettings(shape.half_length, shape.radius);
      return withVec([0, 0, 0], (p) => withQuat(alongZ,
        (q) => created(new Jolt.RotatedTranslatedShapeSettings(p, q, own))));
    }
    // Held for ever by one more reference, for all bodies that are still to come.
    if (shape.kind === 'hull' || shape.kind === 'mesh') {
      if (!shared[shape.data]) {
        shared[shape.data] = (shape.kind === 'hull' ? hullOf : meshOf)(scene.data[shape.data]);
        shared[shape.data].AddRef();
      }
      return shared[shape.data];
    }
    return new Jolt.PlaneShape(new Jolt.Plane(new Jolt.Vec3(0, 0, 1), 0));
  };
  const isIdentity = ({ position, rotation }) =>
    position.every((x) => x === 0) && rotation[3] === 1;
  const shapeOfBody = ({ parts }) => {
    if (parts.length === 1 && isIdentity(parts[0].pose)) return shapeOf(parts[0].shape);
    const compound = new Jolt.StaticCompoundShapeSettings();
    for (const { shape, pose } of parts) {
      withVec(pose.position, (p) => withQuat(pose.rotation,
        (q) => compound.AddShapeShape(p, q, shapeOf(shape), 0)));
    }
    return created(compound);
  };

  // Who is joined does not meet: one table of the pairs of all bodies that have joints.
  const place = new Map();
  for (const { a, b } of scene.joints) for (const i of [a, b]) if (!place.has(i)) place.set(i, place.size);
  const filter = place.size > 0 ? new Jolt.GroupFilterTable(place.size) : null;
  for (const { a, b } of scene.joints) filter.DisableCollision(place.get(a), place.get(b));

  const MOTIONS = {
    dynamic: Jolt.EMotionType_Dynamic, kinematic: Jolt.EMotionType_Kinematic, fixed: Jolt.EMotionType_Static,
  };
  const made = [], joints = [];

  function addBody(i) {
    const body = scene.bodies[i];
    const layer = body.motion === 'fixed' ? STANDING : MOVING;
    const creation = withRVec(body.pose.position, (p) => withQuat(body.pose.rotation,
      (q) => new Jolt.BodyCreationSettings(shapeOfBody(body), p, q, MOTIONS[body.motion], layer)));
    creation.mFriction = body.parts[0].friction;
    creation.mRestitution = body.parts[0].restitution;
    creation.mLinearDamping = creation.mAngularDamping = 0;
    creation.mAllowSleeping = false;
    if (place.has(i)) creation.mCollisionGroup = new Jolt.CollisionGroup(filter, 0, place.get(i));
    if (body.motion !== 'fixed') {
      withVec(body.velocity, (v) => { creation.mLinearVelocity = v; });
      withVec(body.spin, (w) => { creation.mAngularVelocity = w; });
    }
    if (body.motion === 'dynamic') {
      creation.mOverrideMassProperties = Jolt.EOverrideMassProperties_MassAndInertiaProvided;
      creation.mMassPropertiesOverride.mMass = body.mass;
      withVec(body.moments, (m) => {
        creation.mMassPropertiesOverride.mInertia = Jolt.Mat44.prototype.sScaleVec3(m);
      });
    }
    made[i] = bodies.CreateBody(creation);
    bodies.AddBody(made[i].GetID(), Jolt.EActivation_Activate);
    Jolt.destroy(creation);
  }

  function addJoint(i) {
    const joint = scene.joints[i];
    let creation;
    if (joint.kind === 'ball') {
      creation = new Jolt.PointConstraintSettings();
    } else {
      creation = new Jolt.HingeConstraintSettings();
      withVec(joint.z_a, (z) => { creation.mHingeAxis1 = z; });
      withVec(joint.z_b, (z) => { creation.mHingeAxis2 = z; });
      withVec(joint.x_a, (x) => { creation.mNormalAxis1 = x; });
      withVec(joint.x_b, (x) => { creation.mNormalAxis2 = x; });
      if (joint.lower !== null) {
        creation.mLimitsMin = joint.lower;
        creation.mLimitsMax = joint.upper;
      }
    }
    creation.mSpace = Jolt.EConstraintSpace_LocalToBodyCOM;
    withRVec(joint.in_a.position, (p) => { creation.mPoint1 = p; });
    withRVec(joint.in_b.position, (p) => { creation.mPoint2 = p; });
    joints[i] = creation.Create(made[joint.a], made[joint.b]);
    system.AddConstraint(joints[i]);
  }

  scene.bodies.forEach((body, i) => { if (body.from_start) addBody(i); });
  scene.joints.forEach((joint, i) => { if (joint.from_start) addJoint(i); });
  system.OptimizeBroadPhase();

  return {
    settings: 'float; 10 velocity, 2 position iterations',
    step() { jolt.Step(dt, 1); },
    launch({ body, velocity, spin }) {
      if (!made[body]) return;
      withVec(velocity, (v) => withVec(spin,
        (w) => bodies.SetLinearAndAngularVelocity(made[body].GetID(), v, w)));
    },
    addBody,
    addJoint,
    removeJoint(i) {
      system.RemoveConstraint(joints[i]);
      joints[i] = null;
    },
    removeBody(i) {
      const id = made[i].GetID();
      bodies.RemoveBody(id);
      bodies.DestroyBody(id);
      made[i] = null;
    },
    pose(i) {
      if (!made[i]) return null;
      const p = made[i].GetPosition(), q = made[i].GetRotation();
      return { p: [p.GetX(), p.GetY(), p.GetZ()], q: [q.GetX(), q.GetY(), q.GetZ(), q.GetW()] };
    },
  };
}
