// A beam of square section along x, from -span/2 to span/2, in two halves that meet in its neutral plane z = 0.
// `left` and `right` are the lines at mid-height of its ends, on which it is simply supported.
// The centre of the upper face is the middle of a facet: a force there is shared by three nodes.
If (!Exists(span)) span = 0.1535; EndIf
If (!Exists(side)) side = 0.01; EndIf
If (!Exists(size)) size = 0.0025; EndIf
If (!Exists(middle)) middle = 0.005; EndIf   // side of that facet

Macro Section
  // six points of a section at x
  For k In {0:2}
    Point(base + 2*k + 1) = {x, -side/2, (k - 1)*side/2, size};
    Point(base + 2*k + 2) = {x, side/2, (k - 1)*side/2, size};
  EndFor
  For k In {0:2}
    Line(base + k + 1) = {base + 2*k + 1, base + 2*k + 2};
  EndFor
  For k In {0:1}
    Line(base + 4 + 2*k) = {base + 2*k + 1, base + 2*k + 3};
    Line(base + 5 + 2*k) = {base + 2*k + 2, base + 2*k + 4};
    Curve Loop(base + k + 1) = {base + k + 1, base + 5 + 2*k, -(base + k + 2), -(base + 4 + 2*k)};
    Plane Surface(base + k + 1) = {base + k + 1};
  EndFor
Return

base = 0; x = -span/2; Call Section;
base = 100; x = span/2; Call Section;
For k In {1:6}
  Line(200 + k) = {k, 100 + k};
EndFor
// floors: bottom, neutral plane, top
For k In {0:2}
  Curve Loop(210 + k) = {k + 1, 202 + 2*k, -(101 + k), -(201 + 2*k)};
  Plane Surface(210 + k) = {210 + k};
EndFor
// sides
For k In {0:1}
  Curve Loop(220 + 2*k) = {4 + 2*k, 203 + 2*k, -(104 + 2*k), -(201 + 2*k)};
  Plane Surface(220 + 2*k) = {220 + 2*k};
  Curve Loop(221 + 2*k) = {5 + 2*k, 204 + 2*k, -(105 + 2*k), -(202 + 2*k)};
  Plane Surface(221 + 2*k) = {221 + 2*k};
  Surface Loop(1 + k) = {1 + k, 101 + k, 210 + k, 211 + k, 220 + 2*k, 221 + 2*k};
  Volume(1 + k) = {1 + k};
EndFor
For k In {0:2}
  Point(300 + k) = {middle/Sqrt(3)*Cos(2*Pi*k/3), middle/Sqrt(3)*Sin(2*Pi*k/3), side/2, size};
EndFor
For k In {0:2}
  Line(310 + k) = {300 + k, 300 + (k + 1)%3};
  Transfinite Curve{310 + k} = 2;
  Curve{310 + k} In Surface{212};
EndFor

Physical Volume("beam") = {1, 2};
Physical Curve("left") = {2};
Physical Curve("right") = {102};
