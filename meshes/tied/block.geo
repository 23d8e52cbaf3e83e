// Block 30 x 30 x 20 mm below z = 0 with a core of 3.2 x 3.2 x 1.6 mm in the middle of its top, which cases fill with
// bonded particles; graded from the core outwards. Lengths are millimetres.
SetFactory("OpenCASCADE");

DefineConstant[
  h = 0.32,          // element size at the core
  far = 4            // element size far from it
];

c = 1.6;
Box(1) = {-15, -15, -20, 30, 30, 20};
Box(2) = {-c, -c, -c, 2*c, 2*c, c};
Coherence;
e = 1e-3;
core() = Volume In BoundingBox {-c - e, -c - e, -c - e, c + e, c + e, e};
bottom() = Surface In BoundingBox {-15 - e, -15 - e, -20 - e, 15 + e, 15 + e, -20 + e};

all() = Volume {:};
Physical Volume("block") = {all()};
Physical Volume("core") = {core()};
Physical Surface("bottom") = {bottom()};

Field[1] = Box;
Field[1].XMin = -c; Field[1].XMax = c;
Field[1].YMin = -c; Field[1].YMax = c;
Field[1].ZMin = -c; Field[1].ZMax = 0;
Field[1].VIn = h;
Field[1].VOut = far;
Field[1].Thickness = 12;
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.Algorithm = 6;
Mesh.Algorithm3D = 1;
Mesh.Optimize = 1;
