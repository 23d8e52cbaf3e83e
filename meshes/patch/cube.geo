// Small cube of irregular tetrahedra for the patch test. Lengths in metres.
SetFactory("OpenCASCADE");

DefineConstant[
  L = 0.1            // edge
  fine = 0.025       // element size at the corner (0, 0, 0)
  coarse = 0.050     // and at the corner (L, L, L)
];

Box(1) = {0, 0, 0, L, L, L};
e = L/1000;
x_min() = Surface In BoundingBox {-e, -e, -e, e, L + e, L + e};
x_max() = Surface In BoundingBox {L - e, -e, -e, L + e, L + e, L + e};
y_min() = Surface In BoundingBox {-e, -e, -e, L + e, e, L + e};
y_max() = Surface In BoundingBox {-e, L - e, -e, L + e, L + e, L + e};
z_min() = Surface In BoundingBox {-e, -e, -e, L + e, L + e, e};
z_max() = Surface In BoundingBox {-e, -e, L - e, L + e, L + e, L + e};
all() = Boundary { Volume{1}; };

Physical Volume("cube") = {1};
Physical Surface("surface") = {all()};
Physical Surface("x_min") = {x_min()};
Physical Surface("x_max") = {x_max()};
Physical Surface("y_min") = {y_min()};
Physical Surface("y_max") = {y_max()};
Physical Surface("z_min") = {z_min()};
Physical Surface("z_max") = {z_max()};

Field[1] = MathEval;
Field[1].F = Sprintf("%g + %g*(x + y + z)", fine, (coarse - fine)/(3*L));
Background Field = 1;

Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.Optimize = 1;
