//! Tables as Parquet: a column is of numbers if all its texts are, else of texts; what is empty is null.

use std::io::{self, Write};
use std::sync::Arc;

use parquet::basic::{ConvertedType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::{Type, TypePtr};

use super::table::Table;

/// Writes a table in one row group, uncompressed.
///
/// # Errors
/// What the writer says.
pub fn write(table: &Table, writer: impl Write + Send) -> io::Result<()> {
    write_columns(table, writer).map_err(|error| io::Error::other(error.to_string()))
}

fn write_columns(table: &Table, writer: impl Write + Send) -> Result<(), ParquetError> {
    // What each column is of.
    let texts = |column: usize| table.rows.iter().map(move |row| row[column].as_str());
    let numbers: Vec<Option<Vec<f64>>> = (0..table.names.len()).map(|column| numbers_of(texts(column))).collect();
    let fields: Vec<TypePtr> =
        table.names.iter().zip(&numbers).map(|(name, numbers)| field(name, numbers.is_some())).collect::<Result<_, _>>()?;
    let schema = Arc::new(Type::group_type_builder("table").with_fields(fields).build()?);

    // Column after column; what is null has level 0.
    let mut file = SerializedFileWriter::new(writer, schema, Arc::new(WriterProperties::default()))?;
    let mut group = file.next_row_group()?;
    for (column, numbers) in numbers.iter().enumerate() {
        let Some(mut writer) = group.next_column()? else { break };
        let levels: Vec<i16> = texts(column).map(|text| i16::from(!text.is_empty())).collect();
        match numbers {
            Some(numbers) => writer.typed::<DoubleType>().write_batch(numbers, Some(&levels), None)?,
            None => {
                let texts: Vec<ByteArray> = texts(column).filter(|text| !text.is_empty()).map(ByteArray::from).collect();
                writer.typed::<ByteArrayType>().write_batch(&texts, Some(&levels), None)?
            }
        };
        writer.close()?;
    }
    group.close()?;
    file.close()?;
    Ok(())
}

/// The numbers that texts are, empty ones left out; `None` if any is something else, or there is none.
fn numbers_of<'a>(texts: impl Iterator<Item = &'a str>) -> Option<Vec<f64>> {
    let numbers: Vec<f64> = texts.filter(|text| !text.is_empty()).map(|text| text.parse().ok()).collect::<Option<_>>()?;
    (!numbers.is_empty()).then_some(numbers)
}

fn field(name: &str, is_number: bool) -> Result<TypePtr, ParquetError> {
    let (physical, converted) =
        if is_number { (Physical::DOUBLE, ConvertedType::NONE) } else { (Physical::BYTE_ARRAY, ConvertedType::UTF8) };
    let builder = Type::primitive_type_builder(name, physical).with_repetition(Repetition::OPTIONAL);
    Ok(Arc::new(builder.with_converted_type(converted).build()?))
}

#[cfg(test)]
mod tests {
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field;

    use super::*;

    #[test]
    fn a_table_is_read_back_with_types_and_nulls() {
        let text = |texts: &[&str]| texts.iter().map(|&text| text.to_owned()).collect::<Vec<_>>();
        let table = Table { names: text(&["name", "power", "message"]), rows: vec![text(&["a", "0.5", ""]), text(&["2", "", ""])] };
        let mut file = tempfile::tempfile().unwrap();
        write(&table, &mut file).unwrap();
        let reader = SerializedFileReader::new(file).unwrap();
        let rows: Vec<Vec<(String, Field)>> = reader
            .get_row_iter(None)
            .unwrap()
            .map(|row| row.unwrap().get_column_iter().map(|(name, field)| (name.clone(), field.clone())).collect())
            .collect();
        let of = |name: &str, field: Field| (name.to_owned(), field);
        let string = |text: &str| Field::Str(text.to_owned());
        assert_eq!(rows[0], [of("name", string("a")), of("power", Field::Double(0.5)), of("message", Field::Null)]);
        assert_eq!(rows[1], [of("name", string("2")), of("power", Field::Null), of("message", Field::Null)]);
    }
}
