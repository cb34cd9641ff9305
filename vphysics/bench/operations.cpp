// lie-operations: multiplications and additions of the Lie groups' operators, compared with the
// paper's Table 3. CSV rows: subject, engine, metric, value, unit.
#include <cstdio>

#include "operation_counts.h"

int main() {
  std::puts("subject,engine,metric,value,unit");
  for (const auto& row : vp::test::count_operations_of_the_paper()) {
    std::printf("%s,Virtual Physics,multiplications,%ld,\n", row.name, row.multiplications());
    std::printf("%s,Virtual Physics,additions,%ld,\n", row.name, row.ours.additions);
    std::printf("%s,paper,multiplications,%ld,\n", row.name, row.paper_multiplications);
    std::printf("%s,paper,additions,%ld,\n", row.name, row.paper_additions);
  }
}
