ikgen 1
class "6R general, eliminated to degree 16"
variables 6
free []
snap 0.0
slack 0.0
{
  # the six axes as lines, the goal, and the orders of elimination with their degrees
  six(0.0, 0.0, 1.0, 0.0, 0.0, 0.267, 0.0, 1.0, 0.0, 0.0, 0.0, 0.267, 0.0, 1.0, 0.0, 0.053, 0.0, 0.5515, 0.0, 0.0, -1.0, 0.1305, 0.0, 0.209, 0.0, 1.0, 0.0, 0.1305, 0.0, 0.209, 0.0, 0.0, -1.0, 0.2065, 0.0, 0.112, r02, r01, -r00, r12, r11, -r10, r22, r21, -r20, px + (0.112 * r00 + r02 * -0.2065), py + (0.112 * r10 + r12 * -0.2065), pz + (0.112 * r20 + r22 * -0.2065), 4.0, 8.0, 0.0, 9.0, 8.0, 0.0, 12.0, 8.0, 0.0) -> c1 s1 c2 s2 c3 s3 c4 s4 c5 s5 c6 s6 {
    emit angle(c1, s1) angle(c2, s2) angle(c3, s3) angle(c4, s4) angle(c5, s5) angle(c6, s6)
  }
}
