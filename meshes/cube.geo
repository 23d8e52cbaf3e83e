// Cube of edge 1 m for timing: uniform unstructured tetrahedra, as many as `h` asks for. Not kept in git.
SetFactory("OpenCASCADE");

DefineConstant[
  h = 0.05           // element size
];

Box(1) = {0, 0, 0, 1, 1, 1};
e = 1e-3;
bottom() = Surface In BoundingBox {-e, -e, -e, 1 + e, 1 + e, e};
top() = Surface In BoundingBox {-e, -e, 1 - e, 1 + e, 1 + e, 1 + e};

Physical Volume("cube") = {1};
Physical Surface("bottom") = {bottom()};
Physical Surface("top") = {top()};

Mesh.MeshSizeMin = h;
Mesh.MeshSizeMax = h;
Mesh.Algorithm = 6;
Mesh.Algorithm3D = 1;
Mesh.Optimize = 1;
